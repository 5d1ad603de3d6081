// Messages for steps that fail: which parts burst, which number is not finite, what may cure it.
#pragma once

#include <string>

#include <pliant/body/dynamics.h>

namespace pliant::failure_report {

/// Names parts that have burst at a state, as the beginning of a message; empty if none has.
std::string burst_parts(const Model& model, const State& state);
/// Names the coordinate, velocity, gap or work that is not finite after a step; empty if all are finite.
/// work: of the last evaluation of the step.
std::string not_finite(const Model& model, const State& state, const Workspace<double>& work);
/// Names the term of the equations of motion that is not finite in the step from a state, and what may cure
/// it.
std::string cause(const Dynamics& dynamics, const State& before);

}  // namespace pliant::failure_report
