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

/// Returns the advice "a step of H s reaches the end of the scene", or "a tolerance of E ...", for the first
/// of the tried values with which a trial reaches scene.end with a valid energy balance (energy_gate.h). The
/// steps are the largest stable step at the start and fractions of the failed step; the tolerances are
/// multiples and fractions of the failed tolerance; the last trial is the integrator "auto". Trials take at
/// most `seconds` of wall time together, and end when stop() returns true. If no trial reaches the end, the
/// advice lists the settings of the trials. The function catches all exceptions of the trials.
std::string find_remedy(Scene& scene, const FailedRun& failed, double seconds,
                        const std::function<bool()>& stop);

}  // namespace pliant
