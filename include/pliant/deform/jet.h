// Jets: the values and derivatives that the chain of deformations computes for each material point. S is the
// number type: Pack (four points at once), Dual<1, Pack> (with directional derivatives) or another scalar.
//   s                position on the reference shape (m, body frame), Eq. (3)
//   s1 = J qs_dot    rate of s (m/s), Eq. (7)
//   s2 = Jdot qs_dot second time derivative of s for constant qs_dot (m/s^2)
//   J                columns ds/dq_s of the dynamic parameters, in the order of q_s, Eq. (9)
#pragma once

#include <array>

#include <pliant/math/types.h>

namespace pliant {

/// The values of one material point, or of the four points of a Pack.
template <class S>
struct Jet {
  Vec3<S> s, s1, s2;
  std::array<Vec3<S>, kMaxGlobal> J;
};

/// The quantities to compute. position: s. jacobian: s and J. rates: s, J, s1 and s2.
enum class Level { position, jacobian, rates };

/// An array of jets that a chain processes together.
template <class S>
struct JetBatch {
  Jet<S>* jet;
  int count;      ///< number of jets
  int n_columns;  ///< number of columns of J computed so far
  Level level;
};

}  // namespace pliant
