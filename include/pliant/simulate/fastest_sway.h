// The fastest small oscillation of parts on joints. Its stiffness comes from all forces at the state, for
// example gravity and joint forces.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Returns the largest angular frequency (rad/s) of the small motions about a state that the joints allow.
/// Returns 0 if the model has no joints, if nothing oscillates, or if the frequency is unknown
/// (sway_is_unknown). The result may be slightly too small, because it is an estimate by Lanczos' method.
/// work: the evaluation by Dynamics::accelerations at the state.
double fastest_sway(const Dynamics& dynamics, const State& state, Workspace<double>& work);

/// Returns whether the fastest oscillation is unknown: the model has joints and parts that deform locally.
/// Dynamics::jvp, which Lanczos' method calls, has no derivatives for such parts.
bool sway_is_unknown(const Model& model);

}  // namespace pliant
