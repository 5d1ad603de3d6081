// Angle theta of a hinge. A hinge is two triangles that share the edge from a to b. Corner c is on the left
// of the edge, corner d on its right:
//   theta = atan2(e/|e| . (n x m), n . m),   e = b - a,  n = e x (c - a),  m = (d - a) x e.
// theta is positive on a ridge. If c or d moves by z along the normal of its triangle, theta changes by
// -z/height, where height is the distance of the corner from the edge. Let g_a, g_b, g_c and g_d be the
// gradients at the corners, and r_c and r_d the positions of the feet of c and d on the edge (0 at a, 1 at
// b):
//   g_a = -(1 - r_c) g_c - (1 - r_d) g_d,   g_b = -r_c g_c - r_d g_d.
#pragma once

#include <array>

#include <Eigen/Geometry>

#include <pliant/math/scalar/functions.h>
#include <pliant/math/types.h>

namespace pliant {

/// Vectors at the corners a, b, c, d.
template <class T>
using HingeCorners = std::array<Vec3<T>, 4>;

/// Returns the sine and cosine of theta, both multiplied by |n| |m|.
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
