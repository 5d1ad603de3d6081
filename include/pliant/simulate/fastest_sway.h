// The fastest small oscillation of parts on joints, to which joint forces and gravity give a stiffness.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Returns the largest angular frequency (rad/s) of small motions about a state. Only motions that the joints
/// allow count. All forces at the state contribute to the stiffness. Returns 0 if nothing oscillates, or if
/// the frequency is unknown. Lanczos' method on directional derivatives of the accelerations computes it, and
/// the result is slightly too small. work: the evaluation by Dynamics::accelerations at the state.
double fastest_sway(const Dynamics& dynamics, const State& state, Workspace<double>& work);

/// Returns whether the fastest oscillation is unknown: the model has joints, and it has parts that deform
/// locally, for whose accelerations Dynamics::jvp has no derivatives.
bool sway_is_unknown(const Model& model);

}  // namespace pliant
