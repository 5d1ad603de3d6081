// A state between those of long steps, for pictures and meshes: of a step of its own that begins where the
// step does, so that it is as near to the motion as the states at steps are.
#pragma once

#include <optional>

#include <pliant/body/model.h>
#include <pliant/body/state.h>

namespace pliant {

/// The state at a part x, from 0 to 1, of the step from one state to the next. between: q half-way as
/// interpolation has it. None where steps of an explicit method do not lead from one state to the other much
/// more closely than interpolation follows them, as where something struck or is stiff in between.
std::optional<State> step_between(const Model& model, const State& low, const State& high, double x,
                                  const VecX<double>& between);

}  // namespace pliant
