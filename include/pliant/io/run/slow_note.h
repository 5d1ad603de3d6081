// A note of a run that hardly advances.
#pragma once

#include <string>

#include <pliant/simulate/simulation.h>

namespace pliant {

/// Returns a warning with the time, the part and the counts of Simulation::slow_progress(), and a remedy. The
/// text is empty if slow_progress() of the simulation is empty.
std::string slow_progress_note(const Simulation& simulation);
/// Returns whether a note is one of slow_progress_note().
bool is_slow_progress_note(const std::string& note);

}  // namespace pliant
