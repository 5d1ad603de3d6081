// One-sided constraints on velocities, with impulses lambda, or on accelerations, with forces lambda. Each
// row has a lambda >= 0 and a slack, which is the entry of W lambda + b. One of the two is zero:
//   0 <= lambda  _|_  W lambda + b >= 0,   W = C M^-1 C^T symmetric positive semi-definite
// The limits of parameters and the strings use this problem.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// The solution lambda and its accuracy.
template <int Max = Eigen::Dynamic>
struct ComplementarityResult {
  VecMax<double, Max> lambda;
  /// Largest violation of the conditions lambda >= 0, slack >= 0 and lambda slack = 0, in units of b.
  double residual = 0;
  int pivots = 0;  ///< number of linear systems solved
};

/// Maximum number of one-sided rows from the limits of one part: two for each parameter.
inline constexpr int kMaxLimitRows = 2 * kMaxGlobal;

/// Returns the solution of the convex problem min 1/2 lambda^T W lambda + b^T lambda over lambda >= 0, by an
/// active-set method. W: n x n; b: n. The lambda of an active row keeps its slack at zero. The most violated
/// row becomes active first; other rows can be released on the way. The objective decreases with every
/// change, so the method terminates; in any case it ends after about 50 n + 50 linear systems. A row that
/// depends on the active rows (rank-deficient W) keeps lambda = 0 if the active rows also satisfy this row.
/// Rows that contradict the active rows, and rows whose diagonal entry of W is zero, keep lambda = 0; the
/// residual reports their violation. Max: Eigen::Dynamic, or kMaxLimitRows for a solution without heap
/// allocation.
template <int Max>
ComplementarityResult<Max> solve_complementarity(const MatMax<double, Max>& W, const VecMax<double, Max>& b);

extern template ComplementarityResult<Eigen::Dynamic> solve_complementarity(const MatX<double>&,
                                                                            const VecX<double>&);
extern template ComplementarityResult<kMaxLimitRows> solve_complementarity(
    const MatMax<double, kMaxLimitRows>&, const VecMax<double, kMaxLimitRows>&);

}  // namespace pliant
