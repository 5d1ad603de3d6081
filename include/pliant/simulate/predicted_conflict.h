// Why a step fails may be that its joints cannot close at its end, which a method that iterates, or shortens
// its steps, does not come to tell.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Throws UnsatisfiableModel where closed joints, as the parts are at a state, could not be closed a step of
/// h (s) later, or a little later still. Does nothing where that cannot be told.
void fail_on_predicted_conflict(const Dynamics& dynamics, const State& state, double h);

}  // namespace pliant
