#include "predicted_conflict.h"

#include <algorithm>

#include <pliant/body/step_failure.h>
#include <pliant/project/project.h>

namespace pliant {

namespace {
/// Longest look ahead beyond two, in times of the stabilization; how much further each is than the last.
constexpr double kLongest = 0.01, kFurther = 10;
}  // namespace

void fail_on_predicted_conflict(const Dynamics& dynamics, const State& state, double h) {
  if (dynamics.model().joints().empty()) return;
  const double rate = dynamics.model().body().stabilization.rate, longest = rate > 0 ? kLongest / rate : h;
  for (double ahead = h; ahead <= std::max(longest, kFurther * h); ahead *= kFurther) try {
      Workspace<double> work;
      StepCounters counters;
      State then = state;
      dynamics.accelerations(state.time(), state.q, state.v, state, work);
      project_joints(dynamics, state.time() + ahead, then, work, counters);
    } catch (const UnsatisfiableModel& failure) {
      throw UnsatisfiableModel(failure.what(), state.time());
    } catch (const StepFailure&) {
      return;
    }
}

}  // namespace pliant
