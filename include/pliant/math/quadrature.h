// One-dimensional quadrature on [0, 1].
#pragma once

#include <vector>

namespace pliant {

struct QuadratureNode {
  double x;    ///< in (0, 1)
  double gap;  ///< 1 - x, accurate near 1
  double weight;
};

/// Gauss-Legendre with n points: exact for polynomials of degree 2n - 1.
std::vector<QuadratureNode> gauss_rule(int n);

/// n points for integrands with an algebraic or logarithmic singularity at 0: Gauss-Legendre in y, x = y^q, q
/// >= 1.
std::vector<QuadratureNode> one_end_rule(int n, double q = 4);

/// 2n points for singularities at both ends: one_end_rule on either half.
std::vector<QuadratureNode> both_ends_rule(int n);

}  // namespace pliant
