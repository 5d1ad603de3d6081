// The rotation vector of a rotation matrix Q: the axis times the angle theta in [0, pi],
//   (theta / sin theta) (Q_32 - Q_23, Q_13 - Q_31, Q_21 - Q_12) / 2,   cos theta = (tr Q - 1) / 2
#pragma once

#include <pliant/math/scalar/functions.h>
#include <pliant/math/types.h>

namespace pliant {

/// Returns theta / sin theta for theta in [0, pi), from cos theta and sin^2 theta.
template <class T>
T angle_over_sine(const T& cosine, const T& sine2) {
  const T x = (T(1.0) - cosine) * T(0.5);  // sin^2(theta / 2)
  const double size = plain(x);
  if (size > 0.1) {
    const T sine = math::sqrt(sine2);
    // Near a half turn the angle comes from the sine, which is accurate there. Near a right angle the angle
    // comes from the cosine, because the slope of asin is infinite there.
    const T angle = plain(cosine) < -0.7 ? T(T(kPi / 2) + math::acos(sine)) : T(math::acos(cosine));
    return angle / sine;
  }
  // asin(sqrt x) / sqrt(x (1 - x)) = sum of (2 / 3) (4 / 5) ... (2 n / (2 n + 1)) x^n
  const int terms = size < 1e-8 ? 3 : (size < 1e-3 ? 6 : 17);
  T sum(1.0);
  for (int n = terms; n > 0; --n) sum = T(1.0) + sum * x * T(2.0 * n / (2 * n + 1));
  return sum;
}

/// A rotation with cos theta at or below this value is treated as a half turn. The sign of the axis of a half
/// turn is not defined, so rotation_vector first rotates Q by kHalfTurnOffset about the coordinate axis that
/// is nearest to the axis of Q. The result is the rotation vector of this rotated matrix.
inline constexpr double kHalfTurnCosine = -1 + 1e-12;
inline constexpr double kHalfTurnOffset = 1e-5;  // rad

/// Returns cos theta of a rotation matrix.
template <class T>
T rotation_cosine(const Mat3<T>& Q) {
  return (Q(0, 0) + Q(1, 1) + Q(2, 2) - T(1.0)) * T(0.5);
}

/// Returns a half turn Q rotated by kHalfTurnOffset about the coordinate axis that is nearest to its axis.
template <class T>
Mat3<T> off_half_turn(const Mat3<T>& Q) {
  int k = 0;  // the nearest coordinate axis
  for (int i = 1; i < 3; ++i)
    if (plain(Q(i, i)) > plain(Q(k, k))) k = i;
  const int a = (k + 1) % 3, b = (k + 2) % 3;
  const T c(std::cos(kHalfTurnOffset)), s(std::sin(kHalfTurnOffset));
  Mat3<T> off = Q;
  off.col(a) = Q.col(a) * c + Q.col(b) * s;
  off.col(b) = Q.col(b) * c - Q.col(a) * s;
  return off;
}

/// Returns the rotation vector (rad) of a rotation matrix. For a half turn the result has an error of
/// kHalfTurnOffset. For a matrix that is not a rotation the result has no meaning; it may be NaN.
template <class T>
Vec3<T> rotation_vector(const Mat3<T>& rotation) {
  const Mat3<T> Q = plain(rotation_cosine(rotation)) <= kHalfTurnCosine ? off_half_turn(rotation) : rotation;
  const Vec3<T> v(T(0.5) * (Q(2, 1) - Q(1, 2)), T(0.5) * (Q(0, 2) - Q(2, 0)),
                  T(0.5) * (Q(1, 0) - Q(0, 1)));  // its length is sin theta
  return v * angle_over_sine(rotation_cosine(Q), T(v.dot(v)));
}

}  // namespace pliant
