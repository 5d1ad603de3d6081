// Thinning of a quadrature rule (theorems of Caratheodory and Tchakaloff): for a set of functions that span r
// dimensions, a rule with n nodes has a subrule of at most r nodes with positive weights and equal integrals.
#pragma once

#include <Eigen/Core>

namespace pliant {

/// Returns n factors c >= 0 for the weights of the n nodes; most factors are 0.
/// F: one row for each node, one column for each function; F(i, k) is the contribution of node i to the
/// integral of function k. The result satisfies F^T c = F^T 1. The error of an integral, relative to the sum
/// of |F(i, k)| over i, is a rounding error or at most `tolerance`. rank_found (may be null) receives the
/// numerical rank of F. The rule is exact for the whole space of functions only if F has more columns than
/// this rank; the caller checks this.
Eigen::VectorXd thin_rule(const Eigen::MatrixXd& F, Eigen::Index* rank_found = nullptr,
                          double tolerance = 1e-15);

}  // namespace pliant
