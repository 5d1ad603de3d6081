// The largest stable step, and the cause that limits it.
#pragma once

#include <string>

#include <pliant/simulate/simulation.h>

namespace pliant {

struct StableStep {
  double step;        ///< the result of largest_stable_step(), s
  std::string limit;  ///< the cause, e.g. "the local elasticity of part 'jelly'"; empty: none
  /// The reason why the true limit may differ from `step`, for example a cause that is not included; empty:
  /// none.
  std::string uncounted;
};
/// Returns the largest stable step at the current state, with its cause.
StableStep stable_step(const Simulation& simulation);

}  // namespace pliant
