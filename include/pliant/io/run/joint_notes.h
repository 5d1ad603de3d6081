// What is to be said of a system of joints, before a run and at its end.
#pragma once

#include <string>
#include <vector>

#include <pliant/simulate/simulation.h>

namespace pliant {

/// Which joints have rows that follow from those of others at the state of the simulation, in words, and
/// which such rows disagree with those others, or have no direction; nothing where none has. Rows that follow
/// change no motion, and the forces are shared out as if they were not there.
std::vector<std::string> redundancy_notes(const Simulation& simulation);

/// How many joints have yet to close, and the widest of them, in words; empty when none has.
std::string open_joints_note(const Simulation& simulation);

/// The impulses of joints that took hold of moving parts, from number `first` of simulation.engage_impulses()
/// on, in words: of each moment the largest; and those of paths whose rate jumps, of each joint the first.
std::vector<std::string> engage_notes(const Simulation& simulation, std::size_t first);

/// How the systems of the joints are solved: "blocks", "augmented", "blocks and augmented", or nothing.
std::string solver_note(const Model& model);

/// Widest gaps at the state of a simulation, m; 0 where there is no such joint. A joint counts as closed when
/// it is held so by projection, and without projection when its gap is one that would be (kClosedGap).
struct Gaps {
  double closed = 0, open = 0;
};
Gaps widest_gaps(const Simulation& simulation);

}  // namespace pliant
