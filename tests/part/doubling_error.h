// The error of the mass points of a part, measured against a rule with twice the nodes along each direction.
#pragma once

#include <algorithm>
#include <cmath>

#include <pliant/part/part.h>
#include <pliant/part/sum_inertia.h>

#include "random_state.h"
#include "worst.h"

namespace pliant::test {

/// Returns a state within the declared ranges of the dynamic parameters. Lengths are between half and twice
/// their rest values; other parameters are at most 5 in absolute value. corner: 0 for the largest values, 1
/// for the smallest values, 2 and 3 for largest and smallest values in turn; for other numbers the values are
/// random.
inline RandomState random_in_range(Draws& draws, const Part& part, int corner) {
  const Parameters& all = part.parameters();
  const int n = all.n_dynamic();
  RandomState state{VecMax<double>(n), VecMax<double>(n), draws.vector(2)};
  for (int k = 0; k < n; ++k) {
    const Parameter& p = all.moving(k);
    const double rest = p.rest_value();
    const double low = p.spec->relative ? 0.5 * rest : std::max(p.limits.min, -5.0);
    const double high = p.spec->relative ? 2 * rest : std::min(p.limits.max, 5.0);
    const bool largest = corner == 0 || (corner == 2 && k % 2 == 0) || (corner == 3 && k % 2 == 1);
    state.q_s[k] = corner > 3 ? draws.uniform(low, high) : largest ? high : low;
    state.q_s_dot[k] = draws.uniform(-1, 1) * (p.spec->relative ? rest : 1.0);
  }
  return state;
}

/// Returns the largest change of M and g_q, relative to their scale, if the number of quadrature nodes along
/// each direction is doubled. part: a prepared part. trials: number of states.
inline double doubling_error(const Part& part, int trials) {
  Draws draws(3);
  const MassPoints finer = place_mass_points(part, 1);
  Worst worst;
  for (int trial = 0; trial < trials; ++trial) {
    const RandomState state = random_in_range(draws, part, trial);
    Inertia<double> a, b;
    Counters counters;
    sum_inertia(part, part.mass_points(), state.q_s, state.q_s_dot, state.omega, a, counters);
    sum_inertia(part, finer, state.q_s, state.q_s_dot, state.omega, b, counters);
    const VecX<double> scale = b.M.diagonal().cwiseSqrt();
    const double force = (VecX<double>(b.g_q).array() / scale.array()).abs().maxCoeff();
    for (Eigen::Index i = 0; i < scale.size(); ++i) {
      worst.note(std::abs(a.g_q[i] - b.g_q[i]) / (scale[i] * force));
      for (Eigen::Index j = 0; j <= i; ++j)
        worst.note(std::abs(a.M(i, j) - b.M(i, j)) / (scale[i] * scale[j]));
    }
  }
  return worst;
}

}  // namespace pliant::test
