// Prediction of joints that contradict each other at the end of a step. Methods that iterate, or that shorten
// their steps, fail before they reach the contradiction.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// Throws UnsatisfiableModel if the projection of joints finds a contradiction h seconds after the state, or
/// at a few later times: up to 10 h, or up to 0.01 / Stabilization::rate if that is later. Only the time is
/// advanced, and with it prescribed paths. Returns otherwise, or if a contradiction can be neither found nor
/// excluded.
void fail_on_predicted_conflict(const Dynamics& dynamics, const State& state, double h);

}  // namespace pliant
