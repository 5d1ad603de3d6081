// The largest stable step, and what sets it.
#pragma once

#include <string>

#include <pliant/simulate/simulation.h>

namespace pliant {

struct StableStep {
  double step;  ///< see largest_stable_step(), s
  std::string
      limit;  ///< what it would be too long for: "the local elasticity of part 'jelly'"; empty: nothing
  /// What may bound it further down and is not counted, in words; empty: nothing.
  std::string uncounted;
};
StableStep stable_step(const Simulation& simulation);

}  // namespace pliant
