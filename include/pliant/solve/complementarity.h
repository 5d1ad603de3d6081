// The velocity-level complementarity core (design 1.6): one-sided rows, each with an impulse lambda >= 0 that
// acts only while its row is tight,   0 <= lambda  _|_  W lambda + b >= 0,   W = C M^-1 C^T symmetric
// positive semi-definite. Parameter limits use it; strings and contacts use the same rows.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

struct ComplementarityResult {
  VecX<double> lambda;
  double residual = 0;  ///< worst violation of the three conditions, in units of b
  int pivots = 0;
};

/// Solves it by principal pivoting with least-index choice, which ends for every W with positive principal
/// minors; rows that add nothing to the rows already tight (rank-deficient W) are left out. The residual is
/// always reported.
ComplementarityResult solve_complementarity(const MatX<double>& W, const VecX<double>& b);

}  // namespace pliant
