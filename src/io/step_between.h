// A state within a long step, for pictures and meshes. A shorter step of order 8 from the start of the long
// step computes this state, so that it is as accurate as the recorded states.
#pragma once

#include <optional>

#include <pliant/body/model.h>
#include <pliant/body/state.h>

namespace pliant {

/// Returns the state at a fraction x (0 to 1) of the step from `low` to `high`, or std::nullopt if a part
/// deforms locally. between: coordinates q interpolated at x = 0.5. Also returns std::nullopt if the explicit
/// step fails or is not much more accurate than the interpolation, for example with an impact or a stiff
/// force.
std::optional<State> step_between(const Model& model, const State& low, const State& high, double x,
                                  const VecX<double>& between);

}  // namespace pliant
