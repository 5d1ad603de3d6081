// The parts that contacts push.
#pragma once

#include <vector>

#include <pliant/contact/contact_problem.h>

namespace pliant {

/// Returns the touched parts that move, with those that joints tie to them.
std::vector<int> parts_touched(const Model& model, const std::vector<Contact>& contacts);
/// Returns whether joints of the parts have prescribed ends.
bool are_driven(const Model& model, const std::vector<int>& parts);
/// Evaluates the masses of touched parts, except those whose nodes move one by one.
void evaluate_touched(const Dynamics& dynamics, const State& state, double t,
                      const std::vector<Contact>& contacts, Workspace<double>& work);
/// Applies the velocities of the impulses to a state, and the displacements since then.
void move_by(const ContactProblem& problem, const Model& model, const Workspace<double>& work, State& state);

}  // namespace pliant
