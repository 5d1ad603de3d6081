// The velocity-level complementarity core (design 1.6): one-sided rows, each with an impulse lambda >= 0 that
// acts only while its row is tight,   0 <= lambda  _|_  W lambda + b >= 0,   W = C M^-1 C^T symmetric
// positive semi-definite. Parameter limits use it; strings and contacts use the same rows.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

template <int Max = Eigen::Dynamic>
struct ComplementarityResult {
  VecMax<double, Max> lambda;
  double residual = 0;  ///< worst violation of the three conditions, in units of b
  int pivots = 0;
};

/// Most one-sided rows that the limits of one part make: two a parameter.
inline constexpr int kMaxLimitRows = 2 * kMaxGlobal;

/// Solves it as the convex problem it is, min 1/2 lambda W lambda + b lambda over lambda >= 0: rows become
/// tight one by one, the one most open first, and others come loose on the way; the value falls with every
/// change, so it ends. Rows that depend on the tight ones (rank-deficient W) need no impulse of their own;
/// rows that contradict them are left open, which the residual shows. Max: Eigen::Dynamic, or kMaxLimitRows,
/// which takes nothing from the heap.
template <int Max>
ComplementarityResult<Max> solve_complementarity(const MatMax<double, Max>& W, const VecMax<double, Max>& b);

extern template ComplementarityResult<Eigen::Dynamic> solve_complementarity(const MatX<double>&,
                                                                            const VecX<double>&);
extern template ComplementarityResult<kMaxLimitRows> solve_complementarity(
    const MatMax<double, kMaxLimitRows>&, const VecMax<double, kMaxLimitRows>&);

}  // namespace pliant
