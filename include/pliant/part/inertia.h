// Mass matrix and inertial forces of a part without local deformation, Eq. (11), in its body frame
// (design 1.3):
//   M = sum m G^T G,   g_q = -sum m G^T b,   G = [I, -[p]x, J],   b = w x (w x p) + 2 w x (J qs_dot) + Jdot
//   qs_dot
// ordered (c, omega, q_s); the first block multiplies R^T cddot.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

template <class S>
struct Inertia {
  // On the heap, so that the parts of a chain lie close together.
  MatX<S> M;        ///< (6 + n_s) x (6 + n_s)
  VecX<S> g_q;      ///< 6 + n_s
  Vec3<S> moment;   ///< sum m p: mass times the centre of mass in the body frame
  double mass = 0;  ///< kg
};

/// A material point of a part in its body frame, as forces, joints and tracks take it.
template <class S>
struct PointJet {
  Vec3<S> p;                              ///< position, m
  Vec3<S> p1;                             ///< J qs_dot, m/s
  Vec3<S> p2;                             ///< Jdot qs_dot, m/s^2
  Eigen::Matrix<S, 3, Eigen::Dynamic> J;  ///< dp/dq_s
};

}  // namespace pliant
