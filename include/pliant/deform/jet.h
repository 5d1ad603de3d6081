// Jets: the values and derivatives that the chain of deformations computes for each material point. S is the
// scalar of a point: Pack (four points at once), Dual<1, Pack> for directional derivatives, or any other
// scalar.
//   s               reference shape, body frame, Eq. (3)
//   s1 = J q_s_dot   its rate, Eq. (7)   s2 = Jdot q_s_dot   its quadratic velocity term
//   J               columns ds/dq_s of the dynamic parameters, in the order of q_s, Eq. (9)
#pragma once

#include <array>

#include <pliant/math/types.h>

namespace pliant {

/// The values of one material point (or of one Pack of them).
template <class S>
struct Jet {
  Vec3<S> s, s1, s2;
  std::array<Vec3<S>, kMaxGlobal> J;
};

/// The quantities to compute: s; J too; s1 and s2 too.
enum class Level { position, jacobian, rates };

/// An array of jets that a chain processes together.
template <class S>
struct JetBatch {
  Jet<S>* jet;
  int count;
  int n_columns;  ///< number of columns of J computed so far
  Level level;
};

}  // namespace pliant
