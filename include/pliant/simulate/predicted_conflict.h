// Prediction of joints that cannot close at the end of a step. A method that iterates, or that shortens its
// steps, fails before it sees the contradiction itself.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Throws UnsatisfiableModel if the closed joints could not close a step of h (s) after the state, or a
/// little later. Returns if that cannot be decided.
void fail_on_predicted_conflict(const Dynamics& dynamics, const State& state, double h);

}  // namespace pliant
