// Thinning of a quadrature (Caratheodory, Tchakaloff): a rule of n nodes that is exact for functions spanning
// r dimensions has a subrule of at most r of its nodes, with positive weights, that gives the same integrals.
#pragma once

#include <Eigen/Core>

namespace pliant {

/// F(i, k): what node i contributes to the integral of function k. Returns factors c >= 0 of the nodes'
/// weights, most of them 0, with F^T c = F^T 1 to rounding in units of each column's absolute sum, or to the
/// tolerance.
/// The functions should be more than their numerical rank; rank_found (if not null) says what that is, so
/// that a caller can see whether they were.
Eigen::VectorXd thin_rule(const Eigen::MatrixXd& F, Eigen::Index* rank_found = nullptr,
                          double tolerance = 1e-15);

}  // namespace pliant
