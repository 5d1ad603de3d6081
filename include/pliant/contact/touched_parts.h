// The parts that are moved by contact impulses: their evaluation, and the application of a solution.
#pragma once

#include <vector>

#include <pliant/contact/contact_problem.h>

namespace pliant {

/// Returns the moving parts at some contacts, with all parts of their islands, sorted.
std::vector<int> parts_touched(const Model& model, const std::vector<Contact>& contacts);
/// Returns whether a joint in the islands of some parts follows a prescribed path. Strings are not examined.
bool are_driven(const Model& model, const std::vector<int>& parts);
/// Returns whether a body at a contact, or a joint in the island of such a body, has prescribed motion. Such
/// bodies may have moved during a step although they are at the same place at both ends.
bool has_prescribed_motion(const Model& model, const std::vector<Contact>& contacts);
/// Evaluates the quantities that ContactProblem needs at a state and a time t (s), and stores them in work:
/// masses of touched parts without joints, and masses and joint factors of touched islands. A part that is
/// touched at its nodes and moves by nodes (moves_by_nodes) is left out. If a part without joints moves by
/// nodes but is touched as a whole, its matrix A = M^-1 (LocalDeformation::compliance) is computed too.
void evaluate_touched(const Dynamics& dynamics, const State& state, double t,
                      const std::vector<Contact>& contacts, Workspace<double>& work);
/// Sets the velocities of a state to those after the impulses, without displacements. problem: has no nodes
/// as movers. work: the evaluation by evaluate_touched().
void apply_velocities(const ContactProblem& problem, const Model& model, const Workspace<double>& work,
                      State& state);
/// Applies a solution to a state: sets the velocities after the impulses, and adds the displacements. work:
/// the evaluation by evaluate_touched().
void apply_solution(const ContactProblem& problem, const Model& model, const Workspace<double>& work,
                    State& state);

}  // namespace pliant
