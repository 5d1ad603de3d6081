// A state within a long step, for pictures and meshes. It is computed by a shorter step of order 8 from the
// start of the long step, so that it is as accurate as the recorded states.
#pragma once

#include <optional>

#include <pliant/body/model.h>
#include <pliant/body/state.h>

namespace pliant {

/// Returns the state at a fraction x (0 to 1) of the step from `low` to `high`. between: q interpolated at x
/// = 0.5. Returns nothing if a part deforms locally, or if the explicit method does not lead from `low` to
/// `high` much more accurately than interpolation, for example because of an impact or a stiff force within
/// the step.
std::optional<State> step_between(const Model& model, const State& low, const State& high, double x,
                                  const VecX<double>& between);

}  // namespace pliant
