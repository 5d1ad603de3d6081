// The two bounds on the error of the energy balance of a run. Above the lower bound the run has a warning,
// above the upper bound the run fails.
#pragma once

#include <string>

#include <pliant/simulate/energy_monitor.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

/// Largest error of the energy balance without a warning, as a share of the energy that could move
/// (EnergyMonitor).
inline constexpr double kReportedEnergyShare = 0.01;
/// Largest error of the energy balance of a run, as a share of the energy that could move. Above this bound,
/// errors of the steps dominate the motion, and the run fails.
inline constexpr double kLargestEnergyShare = 0.5;

/// Throws NumericalFailure if the energies of a simulation are not finite, or if the error of their balance
/// is above kLargestEnergyShare. The message names the part and the kind of energy that has changed most
/// since the state `before`. before: the last recorded state. monitor: has the ledger of the present state.
void require_energy_balance(const Simulation& simulation, const EnergyMonitor& monitor, const State& before);

/// Returns whether a simulation has steps of fixed length and a method of order 1. The errors of such a
/// method are large in most runs, so every run reports them.
bool is_of_first_order(const Simulation& simulation);
/// Returns a note about the largest error of the energy balance of a run; above kReportedEnergyShare the note
/// is a warning. The text is empty if the error is zero, or if the error is at most kReportedEnergyShare and
/// is_of_first_order() is false.
std::string energy_note(const Simulation& simulation, const EnergyMonitor& monitor);
/// Returns whether a note is one of energy_note().
bool is_energy_note(const std::string& note);

}  // namespace pliant
