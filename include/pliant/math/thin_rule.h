// Thinning of a quadrature rule (theorems of Caratheodory and Tchakaloff): for a set of functions that span r
// dimensions, a rule with n nodes has a subrule of at most r nodes with positive weights and equal integrals.
#pragma once

#include <Eigen/Core>

namespace pliant {

/// Returns n factors c >= 0 for the weights of the n nodes. At most r of them are positive, where r is the
/// numerical rank of F: the number of pivots of a QR factorisation of F, with scaled rows and columns, that
/// are larger than `tolerance` times the largest pivot. If r = n, no node can be removed, and all factors are
/// 1. F: one row for each node, one column for each function; F(i, k) is the contribution of node i to the
/// integral of function k. The result satisfies F^T c = F^T 1. The error of an integral, relative to the sum
/// of |F(i, k)| over i, is of the order of rounding or of `tolerance`. rank_found (may be null) receives r.
/// The columns of F may be samples from a space of functions. If r equals the number of columns, the samples
/// may not span the whole space, and the rule may not be exact for this space; the caller checks this case.
Eigen::VectorXd thin_rule(const Eigen::MatrixXd& F, Eigen::Index* rank_found = nullptr,
                          double tolerance = 1e-15);

}  // namespace pliant
