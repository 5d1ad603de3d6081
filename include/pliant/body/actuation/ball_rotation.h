// The rotation of a ball joint as twist and swing, rad. a and b are the frames at its two points, and Q = b^T
// a. The swing turns b_1 to a_1 by the angle theta between them, about an axis perpendicular to both; the
// twist is the rotation about a_1 that remains:
//   C = (twist, swing_y, swing_z)
//   twist = atan2(Q_32 - k Q_31, Q_22 - k Q_21),   k = Q_12 / (1 + Q_11)
//   (swing_y, swing_z) = (theta / sin theta) (-Q_31, Q_21),   cos theta = Q_11
// The twist is in (-pi, pi]. At a swing of pi the twist is not defined.
#pragma once

#include <pliant/body/actuation/hinge_angle.h>
#include <pliant/body/actuation/two_frames.h>
#include <pliant/body/joints/hinge.h>

namespace pliant {

/// Returns (x, y), where atan2(y, x) is the twist of the frame a relative to the frame b.
template <class T>
Vec<T, 2> twist_direction(const Framed<T>& a, const Framed<T>& b) {
  constexpr double least = 1e-12;  // smallest value of 1 + cos theta, for swings near pi
  const Vec3<T> a_1 = b.axes.transpose() * a.axes.col(0), a_2 = b.axes.transpose() * a.axes.col(1);
  const T sum = T(1.0) + a_1[0], k = a_2[0] / (plain(sum) < least ? T(least) : sum);
  return {T(a_2[1] - k * a_1[1]), T(a_2[2] - k * a_1[2])};
}

struct BallRotation : TwoFrames {
  static constexpr const char* name = "ball rotation";
  static constexpr const char* formula = "twist and swing of b^T a";
  static constexpr int rows = 3;
  static constexpr bool one_sided = false;

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    const Vec<T, 2> twist = twist_direction(a, b), swing = Hinge::axis_angle(Vec3<T>(a.axes.col(0)), b.axes);
    return {angle_of(twist[0], twist[1]), T(-swing[1]), swing[0]};
  }
};

}  // namespace pliant
