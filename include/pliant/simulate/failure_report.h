// Texts for the messages of failed steps: parts that have burst, numbers that are not finite, and remedies.
#pragma once

#include <string>

#include <pliant/body/dynamics.h>

namespace pliant::failure_report {

/// Returns a text that names the parts that have burst at a state; empty if there is none. A part has burst
/// if a node is displaced by more than twice the size of the part.
std::string burst_parts(const Model& model, const State& state);
/// Returns the fault of a state after a step; empty for a valid state. Faults are a gap, velocity, coordinate
/// or work that is not a finite number, squares whose sum is too large, and a quaternion that is not a
/// rotation. work: the last evaluation of the step.
std::string fault_of(const Model& model, const State& state, const Workspace<double>& work);
/// Returns a text that names the first term of the equations of motion that is not finite in the state before
/// a step, at the start or at the end time of the step. If all terms are finite, says that the motion has
/// grown without bound.
std::string cause(const Dynamics& dynamics, const State& before);

/// Returns a text that names the part and the kind of its energy, and the kind of work, that differ most
/// between two states of a model. The potential energy of a part contains the energy of the springs at the
/// part.
std::string largest_energy_change(const Dynamics& dynamics, const State& before, const State& after);
/// Returns "at t = T s, in a step of H s: ".
std::string place(double t, double h);

}  // namespace pliant::failure_report
