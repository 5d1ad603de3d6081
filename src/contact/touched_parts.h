// The parts that impulses at contacts push.
#pragma once

#include <vector>

#include <pliant/contact/contact_problem.h>

namespace pliant {

/// Parts that move and are touched, with those that joints tie to them.
std::vector<int> parts_touched(const Model& model, const std::vector<Contact>& contacts);
/// Whether hands move joints of some parts.
bool are_driven(const Model& model, const std::vector<int>& parts);
/// What the contact problem needs: masses of the parts that it does not move node by node.
void evaluate_touched(const Dynamics& dynamics, const State& state, double t,
                      const std::vector<Contact>& contacts, Workspace<double>& work);
/// Gives a state the velocities that impulses gave, and the ways they went since.
void move_by(const ContactProblem& problem, const Model& model, const Workspace<double>& work, State& state);

}  // namespace pliant
