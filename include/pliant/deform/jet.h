// Jets: what the chain of deformations carries for each material point. S is the scalar of a point: Pack, so
// that four points go at once, or Dual<1, Pack> for directional derivatives; any scalar works.
//   s               reference shape, body frame, Eq. (3)
//   s1 = J qs_dot   its rate            s2 = Jdot qs_dot   its quadratic velocity term
//   J               columns ds/dq_s of the dynamic parameters, in the order of q_s
#pragma once

#include <array>

#include <pliant/math/types.h>

namespace pliant {

template <class S>
struct Jet {
  Vec3<S> s, s1, s2;
  std::array<Vec3<S>, kMaxGlobal> J;
};

/// What is wanted of a batch of jets; each level includes the ones before.
enum class Level { position, jacobian, rates };

template <class S>
struct JetBatch {
  Jet<S>* jet;
  int count;
  int n_columns;  ///< columns of J filled so far
  Level level;
};

}  // namespace pliant
