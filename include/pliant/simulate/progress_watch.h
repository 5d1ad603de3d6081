// Detects a run to a tolerance that hardly advances: very many short steps, or very many evaluations for one
// step.
#pragma once

#include <optional>
#include <string>

#include <pliant/body/step_counters.h>

namespace pliant {

/// Steps in which a simulation has hardly advanced.
struct SlowProgress {
  double time = 0;       ///< end of the last of these steps, s
  double advance = 0;    ///< sum of their lengths, s
  long steps = 0;        ///< number of accepted steps
  long rejected = 0;     ///< number of rejected steps
  long impacts = 0;      ///< number of impacts whose time was located
  long evaluations = 0;  ///< number of evaluations of the accelerations
  std::string fastest;   ///< text: the velocity that changes most in the last step (ErrorScale::worst)
};

/// Counts the accepted steps of a simulation, and their rejected attempts, impacts and evaluations, in
/// windows of consecutive steps.
class ProgressWatch {
 public:
  /// Number of steps in a window. A window is slow if its steps advance by at most kSlowShare of the interval
  /// that the simulation is to advance. At this rate the run needs at least 1e9 steps. In 1000 steps, shipped
  /// scenes with a tolerance of 1e-6 advance by 4e-2 of the interval or more.
  static constexpr long kWindow = 1000;
  static constexpr double kSlowShare = 1e-6;
  /// A window also ends after a step with more evaluations than this number, rejected attempts included; the
  /// window is then slow. The steps of shipped scenes have up to 1715 evaluations.
  static constexpr long kMaxEvaluations = 100000;

  /// Includes an accepted step. Returns the window if it ends with this step and is slow. start, end: times
  /// of the step, s. interval: the time with which the advance is compared, s (Simulation::slow_progress()).
  /// work: the counters of this step. A step that does not begin at the end of the previous step begins a new
  /// window.
  std::optional<SlowProgress> add(double start, double end, double interval, const StepCounters& work);

 private:
  SlowProgress window_;
};

}  // namespace pliant
