// The largest stable step and its limit.
#pragma once

#include <string>

#include <pliant/simulate/simulation.h>

namespace pliant {

struct StableStep {
  double step;  ///< see largest_stable_step(), s
  std::string
      limit;  ///< what limits it: "the local elasticity of part 'jelly'"; empty if nothing does
  /// Limits that are not counted and may be lower, as text; empty: none.
  std::string uncounted;
};
StableStep stable_step(const Simulation& simulation);

}  // namespace pliant
