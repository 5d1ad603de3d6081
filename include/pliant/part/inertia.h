// The mass matrix and the inertial forces of a part without local deformation, Eq. (11), expressed in its
// body frame:
//   M = sum m G^T G,   g_q = -sum m G^T b,   G = [I, -[p]x, J],
//   b = omega x (omega x p) + 2 omega x (J qs_dot) + Jdot qs_dot,
// summed over mass points m at positions p. The rows and columns are in the order (c, omega, q_s). The first
// block of M multiplies R^T c_ddot. inertia-inl.h computes the sums.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

template <class S>
struct Inertia {
  // M and g_q are on the heap, so that the other data of consecutive parts are close together in memory.
  MatX<S> M;        ///< (6 + n_s) x (6 + n_s)
  VecX<S> g_q;      ///< 6 + n_s
  Vec3<S> moment;   ///< sum m p: mass times the centre of mass in the body frame, kg m
  double mass = 0;  ///< kg
};

/// A material point of a part in the body frame, for forces, joints and tracks (recorded paths of points).
template <class S>
struct PointJet {
  Vec3<S> p;                              ///< position, m
  Vec3<S> p1;                             ///< J qs_dot, m/s
  Vec3<S> p2;                             ///< Jdot qs_dot, m/s^2
  Eigen::Matrix<S, 3, Eigen::Dynamic> J;  ///< dp/dq_s, 3 x n_s
};

}  // namespace pliant
