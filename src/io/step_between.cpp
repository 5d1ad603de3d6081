#include "step_between.h"

#include <algorithm>
#include <stdexcept>

#include <pliant/method/dop853.h>

namespace pliant {

namespace {
/// Largest accepted ratio of two differences. The first is between the result of a full explicit step and the
/// recorded state `high`. The second is between the result of an explicit half step and the interpolated q.
/// With a larger ratio, step_between() returns no state.
constexpr double kNearer = 0.1;
}  // namespace

std::optional<State> step_between(const Model& model, const State& low, const State& high, double x,
                                  const VecX<double>& between) {
  const auto& parts = model.parts();
  if (std::any_of(parts.begin(), parts.end(), [](const PartModel& m) { return m.local != nullptr; }))
    return {};
  Dynamics dynamics(model);
  dynamics.set_joint_policy({false, model.body().stabilization.projection.value_or(true), false});
  Dop853 method;
  const ErrorScale size(model, 1);
  const double start = low.time();
  auto after = [&](double part) {
    Workspace<double> work;
    StepCounters counters;
    State state = low;
    state.start = start;
    state.step = 0;
    state.h = part * (high.time() - start);
    StepContext step(dynamics, state, work, counters);
    method.step(step);
    state.start = start + state.h;
    state.h = low.h;
    return state;
  };
  try {
    const double off = size.norm(after(1).q - high.q), apart = size.norm(after(0.5).q - between);
    if (!(off <= kNearer * apart)) return {};
    return after(x);
  } catch (const std::runtime_error&) {  // the explicit step failed
    return {};
  }
}

}  // namespace pliant
