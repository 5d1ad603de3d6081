// What is to be said of contacts: how deep bodies are in each other.
#pragma once

#include <string>
#include <vector>

#include <pliant/integrate/simulation.h>

namespace pliant {

/// The deepest contact at the state of a simulation, as a share of the size of the smaller of its parts;
/// 0 where nothing touches.
double deepest_share(const Simulation& simulation);

/// Bodies that overlap at the state of a simulation by more than counts as resting, in words, the deepest
/// contact of each pair; of many the deepest ones and how many there are.
std::vector<std::string> overlap_notes(const Simulation& simulation);

}  // namespace pliant
