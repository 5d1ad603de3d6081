// The angle of a hinge: the rotation of the first side relative to the second about the pin, in (-pi, pi].
//   C = atan2(a_2 . b_3, a_2 . b_2)
// Here a and b are the frames at the first and the second side of the hinge; b_1 is the direction of the pin.
#pragma once

#include <pliant/body/actuation/two_frames.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

/// Returns the angle in (-pi, pi] of the direction (c, s), which need not be of length 1; 0 for a vector
/// shorter than 1e-12, which has no direction.
template <class T>
T angle_of(const T& c, const T& s) {
  if (!(plain(c) * plain(c) + plain(s) * plain(s) >= 1e-24)) return T(0.0);
  const T length = math::sqrt(T(c * c + s * s)), cosine = c / length, sine = s / length;
  const T sine2 = sine * sine;
  if (plain(cosine) >= 0) return sine * angle_over_sine(cosine, sine2);
  return T(plain(sine) < 0 ? -kPi : kPi) - sine * angle_over_sine(T(-cosine), sine2);
}

struct HingeAngle : TwoFrames {
  static constexpr const char* name = "hinge angle";
  static constexpr const char* formula = "atan2(a_2 . b_3, a_2 . b_2)";
  static constexpr int rows = 1;
  static constexpr bool one_sided = false;

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    const Vec3<T> in_b = b.axes.transpose() * a.axes.col(1);
    return Vec<T, rows>(angle_of(in_b[1], in_b[2]));
  }
};

}  // namespace pliant
