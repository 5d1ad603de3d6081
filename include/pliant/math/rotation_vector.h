// The rotation vector of a rotation Q: its axis times its angle in [0, pi],
//   (theta / sin theta) (Q_32 - Q_23, Q_13 - Q_31, Q_21 - Q_12) / 2,   cos theta = (tr Q - 1) / 2
#pragma once

#include <pliant/math/scalar/functions.h>
#include <pliant/math/types.h>

namespace pliant {

/// theta / sin theta of an angle in [0, pi) by its cosine and the square of its sine.
template <class T>
T angle_over_sine(const T& cosine, const T& sine2) {
  const T x = (T(1.0) - cosine) * T(0.5);  // sin^2(theta / 2)
  const double size = plain(x);
  if (size > 0.1) {
    const T sine = math::sqrt(sine2);
    // Near a half turn by the sine, which is exact there; not near a right angle, where its own slope ends.
    const T angle = plain(cosine) < -0.7 ? T(T(kPi / 2) + math::acos(sine)) : T(math::acos(cosine));
    return angle / sine;
  }
  // asin(sqrt x) / sqrt(x (1 - x)) = sum of (2 / 3) (4 / 5) ... (2 n / (2 n + 1)) x^n
  const int terms = size < 1e-8 ? 3 : (size < 1e-3 ? 6 : 17);
  T sum(1.0);
  for (int n = terms; n > 0; --n) sum = T(1.0) + sum * x * T(2.0 * n / (2 * n + 1));
  return sum;
}

/// A cosine at or below this is that of a half turn, whose axis has no side: rotations are taken a little off
/// it.
inline constexpr double kHalfTurn = -1 + 1e-12;
inline constexpr double kOffHalfTurn = 1e-5;  // rad

template <class T>
Vec3<T> rotation_vector(const Mat3<T>& Q) {
  auto cosine = [](const Mat3<T>& R) { return T((R(0, 0) + R(1, 1) + R(2, 2) - T(1.0)) * T(0.5)); };
  if (plain(cosine(Q)) <= kHalfTurn) {
    int k = 0;  // the axis that is nearest to that of the turn
    for (int i = 1; i < 3; ++i)
      if (plain(Q(i, i)) > plain(Q(k, k))) k = i;
    const int a = (k + 1) % 3, b = (k + 2) % 3;
    const T c(std::cos(kOffHalfTurn)), s(std::sin(kOffHalfTurn));
    Mat3<T> off = Q;
    off.col(a) = Q.col(a) * c + Q.col(b) * s;
    off.col(b) = Q.col(b) * c - Q.col(a) * s;
    return rotation_vector(off);
  }
  const Vec3<T> v(T(0.5) * (Q(2, 1) - Q(1, 2)), T(0.5) * (Q(0, 2) - Q(2, 0)),
                  T(0.5) * (Q(1, 0) - Q(0, 1)));  // of length sin theta
  return v * angle_over_sine(cosine(Q), T(v.dot(v)));
}

}  // namespace pliant
