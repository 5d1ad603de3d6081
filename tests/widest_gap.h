// The widest gap of the joints of a simulation.
#pragma once

#include <algorithm>

#include <pliant/simulate/simulation.h>

namespace pliant::test {

/// Returns the widest gap of all joints, m; 0 if there are no joints.
inline double widest_gap(const Simulation& simulation) {
  double widest = 0;
  for (int j = 0; j < static_cast<int>(simulation.model().joints().size()); ++j)
    widest = std::max(widest, simulation.model().gap(simulation.state(), j));
  return widest;
}

}  // namespace pliant::test
