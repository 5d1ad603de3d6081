// Advice for a failed run, found by trial runs.
#pragma once

#include <functional>
#include <string>

#include <pliant/scene/scene.h>

namespace pliant {

/// A failed run: its method, its fixed step (s; 0 with a tolerance) and its number of threads.
struct FailedRun {
  std::string integrator;
  double step;
  int threads;
};

/// Returns the advice "a step of H s reaches the end of the scene", "a tolerance of E ..." or "the integrator
/// auto ..." for the first trial that reaches scene.end with an error of the energy balance of at most
/// kReportedEnergyShare (energy_gate.h). A run that follows the advice then ends without a warning about this
/// error. If the failed run had fixed steps, the trials have 0.9 times the largest step that is stable at the
/// initial state, and fractions of the step of the failed run. If it had a tolerance, they have multiples and
/// fractions of this tolerance. The last trial has the integrator "auto". A trial that reaches the end with
/// an error above kReportedEnergyShare is repeated with a shorter step or a smaller tolerance; all trials
/// together have at most three repetitions. The trial with "auto" is repeated only if the failed run had this
/// integrator. If the errors of all trials are above kReportedEnergyShare, the advice is the setting with the
/// smallest error, and gives this error. If no trial reaches the end, the advice lists the settings of the
/// trials. All trials together take at most about `seconds` of wall time, and end when stop() returns true.
/// The function catches all exceptions of the trials.
std::string find_remedy(Scene& scene, const FailedRun& failed, double seconds,
                        const std::function<bool()>& stop);

}  // namespace pliant
