// What is to be said of contacts: how deep bodies are in each other.
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

#include <pliant/simulate/simulation.h>

namespace pliant {

/// The deepest contact at the state of a simulation, as a share of the size of the smaller of its parts;
/// 0 where nothing touches.
double deepest_share(const Simulation& simulation);

/// Overlaps below this share of the size of the smaller part are told by nothing but run.json.
inline constexpr double kReportedOverlap = 1e-3;

/// Two things that touch: their parts, the second -1 of a plane or an obstacle, and the numbers of these.
using TouchingPair = std::array<int, 4>;

/// Bodies that overlap at the state of a simulation by more than kReportedOverlap, in words, the deepest
/// contact of each pair that was not told of, with the joints that may hold it there; of many the deepest
/// ones and how many there are. told: gets them; of each once.
std::vector<std::string> overlap_notes(const Simulation& simulation, std::set<TouchingPair>& told);

}  // namespace pliant
