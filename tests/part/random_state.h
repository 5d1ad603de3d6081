// Random states of parts, in all their parameters.
#pragma once

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/part/registry.h>

#include "draws.h"

namespace pliant::test {

/// Returns the range of random values of a parameter. For lengths it is half to twice the rest value, for
/// angles the limits of the parameter. For other parameters it is the part of the limits with absolute values
/// of at most max(2, 2 rest value).
inline Range range_of(const Parameter& p) {
  if (p.spec->relative) return {0.5 * p.rest_value(), 2 * p.rest_value()};
  const double reach = p.spec->quantity == Quantity::angle ? kInfinity : std::max(2.0, 2 * p.rest_value());
  return {std::max(p.limits.min, -reach), std::min(p.limits.max, reach)};
}

/// Returns a random value within the range of a parameter.
inline double draw_value(Draws& draws, const Parameter& p) {
  const Range range = range_of(p);
  return draws.uniform(range.min, range.max);
}
/// Returns one of the two ends of the range of a parameter.
inline double draw_end(Draws& draws, const Parameter& p) {
  const Range range = range_of(p);
  return draws.uniform(0, 1) < 0.5 ? range.min : range.max;
}

/// Dynamic parameters with their rates, and the angular velocity (rad/s, body) of a part.
struct RandomState {
  VecMax<double> q_s, q_s_dot;
  Vec3<double> omega;
};

/// Returns a state with values from value(draws, parameter), random rates and a random angular velocity.
template <class F>
RandomState make_state(Draws& draws, const Part& part, F&& value) {
  const int n = part.parameters().n_dynamic();
  RandomState state{VecMax<double>(n), VecMax<double>(n), draws.vector(2)};
  for (int k = 0; k < n; ++k) {
    const Parameter& p = part.parameters().moving(k);
    state.q_s[k] = value(draws, p);
    state.q_s_dot[k] = draws.uniform(-1, 1) * (p.spec->relative ? p.rest_value() : 1.0);
  }
  return state;
}

/// Returns a random state within the ranges at which the part does not fold over. Throws std::runtime_error
/// if 10000 trials find none.
inline RandomState draw_state(Draws& draws, const Part& part) {
  for (int trial = 0; trial < 10000; ++trial) {
    RandomState state = make_state(draws, part, draw_value);
    if (!part.is_inverted(state.q_s)) return state;
  }
  throw std::runtime_error("no state without folds found");
}
/// Returns a state with every parameter at an end of its range; the part may fold over.
inline RandomState draw_end_state(Draws& draws, const Part& part) {
  return make_state(draws, part, draw_end);
}

/// Makes every parameter dynamic except those named in `except`.
inline void make_all_dynamic(Part& part, const std::vector<std::string>& except = {}) {
  std::vector<std::string> names;
  for (int i = 0; i < part.parameters().size(); ++i) {
    const std::string& name = part.parameters()[i].name;
    if (std::find(except.begin(), except.end(), name) == except.end()) names.push_back(name);
  }
  part.make_dynamic(names);
}

inline ParameterValues<double> values_of(const Part& part, const RandomState& state) {
  return part.parameters().expand<double>(state.q_s, state.q_s_dot);
}

/// Chains of deformations that are tested with every shape.
inline const std::vector<std::vector<std::string>>& test_chains() {
  static const std::vector<std::vector<std::string>> chains{{},
                                                            {"taper"},
                                                            {"twist", "shear"},
                                                            {"bend"},
                                                            {"taper", "bend_offset"},
                                                            {"taper", "twist", "taper"},
                                                            {"shear", "bend", "twist"}};
  return chains;
}

inline std::string describe(const std::string& shape, const std::vector<std::string>& chain) {
  std::string text = shape;
  for (const std::string& link : chain) text += " " + link;
  return text;
}

}  // namespace pliant::test
