// How fast parts with joints sway: the forces of joints and gravity hold them like springs.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// The greatest omega (rad/s) of small motions that the joints allow, about a state with all its forces; 0
/// when none swing. By Lanczos' method on directional derivatives of the accelerations, so slightly from
/// below. work: as Dynamics::accelerations left it there.
double fastest_sway(const Dynamics& dynamics, const State& state, Workspace<double>& work);

}  // namespace pliant
