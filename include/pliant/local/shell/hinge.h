// Angle of a hinge: two triangles that share the edge from a to b. Corner c is on the left of the edge, d on
// its right:
//   theta = atan2(e/|e| . (n x m), n . m),   e = b - a,  n = e x (c - a),  m = (d - a) x e.
// theta is positive on a ridge. If c moves by z along the normal of its triangle, theta changes by -z/height,
// where height is the distance of c from the edge; the same holds for d. The gradients at all four corners
// sum to zero. With r_c the position of the foot of the height of c on the edge (0 at a, 1 at b), and r_d
// that of d, the gradient at a is -(1 - r_c) times that at c minus (1 - r_d) times that at d. The gradient at
// b has -r_c and -r_d as factors.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include <pliant/math/scalar/functions.h>
#include <pliant/math/types.h>

namespace pliant {

/// Vectors at the corners a, b, c, d.
template <class T>
using HingeCorners = std::array<Vec3<T>, 4>;

/// Returns the sine and cosine of theta, both times |n| |m|.
template <class T>
math::SinCos<T> hinge_sin_cos(const HingeCorners<T>& x) {
  const Vec3<T> e = x[1] - x[0];
  const Vec3<T> n = e.cross(Vec3<T>(x[2] - x[0])), m = Vec3<T>(x[3] - x[0]).cross(e);
  return {n.cross(m).dot(e) / math::sqrt(T(e.dot(e))), n.dot(m)};
}

/// Returns dtheta/dx, 1/m.
template <class T>
HingeCorners<T> hinge_gradient(const HingeCorners<T>& x) {
  const Vec3<T> e = x[1] - x[0], c = x[2] - x[0], d = x[3] - x[0];
  const Vec3<T> n = e.cross(c), m = d.cross(e);
  const T length2 = e.dot(e), length = math::sqrt(length2);
  const Vec3<T> left = n * T(length / n.dot(n)), right = m * T(length / m.dot(m));  // normal/height
  const T c_foot = c.dot(e) / length2, d_foot = d.dot(e) / length2;                 // 0 at a, 1 at b
  return {left * T(1.0 - c_foot) + right * T(1.0 - d_foot), left * c_foot + right * d_foot, -left, -right};
}

/// Returns the sum of the scalar products over the corners.
template <class T>
T dot(const HingeCorners<T>& a, const HingeCorners<T>& b) {
  return a[0].dot(b[0]) + a[1].dot(b[1]) + a[2].dot(b[2]) + a[3].dot(b[3]);
}

}  // namespace pliant
