// Messages of failed steps: parts that have burst, numbers that are not finite, and remedies.
#pragma once

#include <string>

#include <pliant/body/dynamics.h>

namespace pliant::failure_report {

/// Returns the beginning of a message, which names the parts that have burst at a state; empty if none has. A
/// part has burst if a node is displaced by more than twice the size of the part.
std::string burst_parts(const Model& model, const State& state);
/// Returns the name of the coordinate, velocity, gap or work that is not finite after a step; empty if all
/// are finite. work: the last evaluation of the step.
std::string not_finite(const Model& model, const State& state, const Workspace<double>& work);
/// Returns the first term of the equations of motion that is not finite in the step from a state, or a remedy
/// if all terms are finite.
std::string cause(const Dynamics& dynamics, const State& before);

}  // namespace pliant::failure_report
