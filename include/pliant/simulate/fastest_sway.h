// How fast parts with joints sway: the forces of joints and gravity hold them like springs.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// The greatest omega (rad/s) of small motions that the joints allow, about a state with all its forces; 0
/// when none swing. By Lanczos' method on directional derivatives of the accelerations, so slightly from
/// below; 0 where it is unknown. work: as Dynamics::accelerations left it there.
double fastest_sway(const Dynamics& dynamics, const State& state, Workspace<double>& work);

/// Whether there are joints, and parts that deform locally: their accelerations have no derivative.
bool sway_is_unknown(const Model& model);

}  // namespace pliant
