// One-dimensional quadrature rules on [0, 1].
#pragma once

#include <vector>

namespace pliant {

/// A node of a rule and its weight.
struct QuadratureNode {
  double x;    ///< in (0, 1)
  double gap;  ///< 1 - x, accurate near 1
  double weight;
};

/// Returns the Gauss-Legendre rule with n points, in ascending order. It is exact for polynomials of degree
/// up to 2n - 1.
std::vector<QuadratureNode> gauss_rule(int n);

/// Returns a rule with n points for integrands with an algebraic or logarithmic singularity at 0: the
/// Gauss-Legendre rule in y, where x = y^q and q >= 1.
std::vector<QuadratureNode> one_end_rule(int n, double q = 4);

/// Returns a rule with 2n points for integrands with singularities at 0 and 1: one_end_rule(n) on each half.
std::vector<QuadratureNode> both_ends_rule(int n);

}  // namespace pliant
