// Function bodies of predicted_conflict.h: projections of the state at predicted times.
#pragma once

#include <pliant/simulate/predicted_conflict.h>

#include <algorithm>

#include <pliant/body/step_failure.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/math/header_only.h>
#include <pliant/project/project.h>

namespace pliant {

namespace predicted_conflict {
/// Longest time of prediction, in units of 1 / Stabilization::rate, and ratio of a time of prediction to the
/// previous one.
inline constexpr double kMaxPrediction = 0.01, kPredictionGrowth = 10;
}  // namespace predicted_conflict

PLIANT_INLINE void fail_on_predicted_conflict(const Dynamics& dynamics, const State& state, double h) {
  if (dynamics.model().joints().empty()) return;
  try {
    Workspace<double> work;
    StepCounters counters;
    State open = state;
    dynamics.accelerations(state.time(), state.q, state.v, state, work);
    StepContext step(dynamics, open, work, counters, state.time(), h);
    fail_on_open_conflict(step);
  } catch (const NumericalFailure&) {
    return;
  } catch (const InvertedElement&) {
    return;
  }
  const double rate = dynamics.model().body().stabilization.rate,
               longest = rate > 0 ? predicted_conflict::kMaxPrediction / rate : h;
  for (double ahead = h; ahead <= std::max(longest, predicted_conflict::kPredictionGrowth * h);
       ahead *= predicted_conflict::kPredictionGrowth)
    try {
      Workspace<double> work;
      StepCounters counters;
      State predicted = state;
      dynamics.accelerations(state.time(), state.q, state.v, state, work);
      StepContext step(dynamics, predicted, work, counters, state.time() + ahead, ahead);
      project_joints(step);
    } catch (const UnsatisfiableModel& failure) {
      throw UnsatisfiableModel(failure.what(), state.time());
    } catch (const StepFailure&) {
      return;
    }
}

}  // namespace pliant
