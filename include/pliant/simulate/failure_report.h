// Texts for the messages of failed steps: parts that have burst, numbers that are not finite, and remedies.
#pragma once

#include <string>

#include <pliant/body/dynamics.h>

namespace pliant::failure_report {

/// Returns a text that names the parts that have burst at a state; empty if there is none. A part has burst
/// if a node is displaced by more than twice the size of the part.
std::string burst_parts(const Model& model, const State& state);
/// Returns the name of the coordinate, velocity, gap or work that is not finite after a step; empty if all
/// are finite. work: the last evaluation of the step.
std::string not_finite(const Model& model, const State& state, const Workspace<double>& work);
/// Returns a text that names the first term of the equations of motion that is not finite at the start or at
/// the end time of the step from a state. If all terms are finite, returns the advice to use a smaller step.
std::string cause(const Dynamics& dynamics, const State& before);

}  // namespace pliant::failure_report
