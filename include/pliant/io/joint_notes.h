// What is to be said of a system of joints before a run.
#pragma once

#include <string>

#include <pliant/integrate/simulation.h>

namespace pliant {

/// Which joints have rows that follow from those of others at the state of the simulation, in words; empty
/// when none has. Such rows change no motion, and the forces are shared out as if they were not there.
std::string redundancy_note(const Simulation& simulation);

/// How the systems of the joints are solved: "blocks", "augmented", "blocks and augmented", or nothing.
std::string solver_note(const Model& model);

/// The widest gap of a joint that is closed, m.
double widest_closed_gap(const Simulation& simulation);

}  // namespace pliant
