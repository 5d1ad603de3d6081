// Parts at random values of all their parameters, short of where their deformations fold over.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/part/registry.h>

#include "draws.h"

namespace pliant::test {

/// Where a parameter of a part may be drawn from, with a body of unit size in mind.
inline double draw_value(Draws& draws, const Parameter& p) {
  const std::string name = p.spec->name;
  if (p.spec->relative) return p.rest_value() * draws.uniform(0.8, 1.25);
  if (name.substr(0, 3) == "eps") return draws.uniform(0.4, 1.6);
  if (name == "a4") return draws.uniform(2.5, 4);
  if (name == "direction") return draws.uniform(-3, 3);
  if (name == "b2") return draws.uniform(-0.5, 0.5);
  if (name == "b3") return draws.uniform(0.3, 0.9);
  if (name == "t") return draws.uniform(-0.9, 0.5);
  return draws.uniform(-0.4, 0.4);
}

struct RandomState {
  VecMax<double> q_s, q_s_dot;
  Vec3<double> omega;
};

inline RandomState draw_state(Draws& draws, const Part& part) {
  const int n = part.parameters().n_dynamic();
  RandomState state{VecMax<double>(n), VecMax<double>(n), draws.vector(2)};
  for (int k = 0; k < n; ++k) {
    const Parameter& p = part.parameters()[part.parameters().dynamic()[static_cast<std::size_t>(k)]];
    state.q_s[k] = draw_value(draws, p);
    state.q_s_dot[k] = draws.uniform(-1, 1) * (p.spec->relative ? p.rest_value() : 1.0);
  }
  return state;
}

/// Every parameter but those called in except becomes a degree of freedom.
inline void free_all(Part& part, const std::vector<std::string>& except = {}) {
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

/// Chains worth trying on every shape.
inline const std::vector<std::vector<std::string>>& usual_chains() {
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
