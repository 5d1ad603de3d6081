// Prediction of joints that contradict each other at the end of a step. Methods that iterate, or that shorten
// their steps, fail before they reach the contradiction.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Throws UnsatisfiableModel if the closed joints cannot close at a time h (s) after the state, or somewhat
/// later. Returns otherwise, or if this cannot be decided.
void fail_on_predicted_conflict(const Dynamics& dynamics, const State& state, double h);

}  // namespace pliant
