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

/// Solves it as the convex problem it is, min 1/2 lambda W lambda + b lambda over lambda >= 0: rows become
/// tight one by one, the one most open first, and others come loose on the way; the value falls with every
/// change, so it ends. Rows that depend on the tight ones (rank-deficient W) need no impulse of their own;
/// rows that contradict them are left open, which the residual shows.
ComplementarityResult solve_complementarity(const MatX<double>& W, const VecX<double>& b);

}  // namespace pliant
