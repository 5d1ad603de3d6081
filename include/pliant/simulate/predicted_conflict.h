// Prediction of joints that contradict each other soon after a state. Methods that iterate, or that shorten
// their steps, fail before the time of the contradiction and cannot name these joints.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Throws UnsatisfiableModel if a joint is open at the state and other joints contradict it, or if the
/// projection of joints finds a contradiction h, 10 h, 100 h, ... seconds after the state. The largest of
/// these times is at most 10 h or 0.01 / Stabilization::rate, whichever is longer. Only the time and the
/// prescribed paths are advanced; parts stay in place. Returns if no contradiction is found, or if a
/// projection fails for another reason.
void fail_on_predicted_conflict(const Dynamics& dynamics, const State& state, double h);

}  // namespace pliant
