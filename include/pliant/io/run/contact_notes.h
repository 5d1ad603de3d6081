// Notes of a run about contact: overlaps of parts, and violations of the laws of contact.
#pragma once

#include <array>
#include <set>
#include <string>
#include <vector>

#include <pliant/simulate/simulation.h>

namespace pliant {

/// Returns the largest ratio of the overlap of a contact to the size of its smaller part, at the state of a
/// simulation; 0 without an overlap.
double deepest_share(const Simulation& simulation);

/// Overlaps above this depth, relative to the size of the smaller part, are reported by a note. Smaller
/// overlaps appear only as "max_depth" in run.json.
inline constexpr double kReportedOverlap = 1e-3;

/// Indices that name both sides of a contact: the first part, then the second part, the plane and the
/// obstacle. Two of the last three are -1.
using TouchingPair = std::array<int, 4>;

/// Returns notes on the pairs that overlap by more than kReportedOverlap at the state of a simulation and are
/// not yet in `reported`. A note gives the deepest contact of a pair and the name of a joint that may prevent
/// the separation. If there are more than ten pairs, only the ten deepest pairs are listed, with the number
/// of the remaining pairs. All these pairs are added to `reported`.
std::vector<std::string> overlap_notes(const Simulation& simulation, std::set<TouchingPair>& reported);

/// Returns warnings about the largest residual and the largest overlap of a run, if they exceed the tolerance
/// of contact. settings: contact settings of the run.
std::vector<std::string> violation_notes(const StepCounters& counters, const ContactSettings& settings);
/// Returns whether a note is one of violation_notes().
bool is_violation_note(const std::string& note);

}  // namespace pliant
