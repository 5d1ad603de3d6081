// Rotations: the matrix of a quaternion, and the quaternion of a rotation vector.
#pragma once

#include <Eigen/Geometry>

#include <pliant/math/scalar/sinc.h>
#include <pliant/math/types.h>

namespace pliant {

/// Returns the rotation matrix R (from the body frame to the world frame) of a quaternion (w, x, y, z) of any
/// nonzero length.
template <class S>
Mat3<S> rotation(const S& w, const S& x, const S& y, const S& z) {
  const S two = S(2.0) / (w * w + x * x + y * y + z * z);
  Mat3<S> R;
  R(0, 0) = S(1.0) - two * (y * y + z * z);
  R(1, 1) = S(1.0) - two * (x * x + z * z);
  R(2, 2) = S(1.0) - two * (x * x + y * y);
  R(0, 1) = two * (x * y - w * z);
  R(1, 0) = two * (x * y + w * z);
  R(0, 2) = two * (x * z + w * y);
  R(2, 0) = two * (x * z - w * y);
  R(1, 2) = two * (y * z - w * x);
  R(2, 1) = two * (y * z + w * x);
  return R;
}

/// Returns the unit quaternion of a rotation vector: the axis times the angle (rad).
inline Eigen::Quaterniond quaternion(const Vec3<double>& turn) {
  const Vec3<double> half = 0.5 * turn;
  const double angle = half.norm();
  const math::SinCos<double> sin_cos_half = math::sin_cos(angle);
  const Vec3<double> axis = sinc(angle, sin_cos_half) * half;
  return {sin_cos_half.cos, axis[0], axis[1], axis[2]};
}

}  // namespace pliant
