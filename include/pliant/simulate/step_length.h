// How long steps are whose errors are controlled (Hairer, Norsett & Wanner, Solving Ordinary Differential
// Equations I, section II.4; the proportional-integral rule of Gustafsson 1991).
#pragma once

#include <algorithm>
#include <limits>

#include <pliant/method/integrator.h>
#include <pliant/method/step_error.h>

namespace pliant {

/// What steps grow by, from one to the next, where they do.
struct StepGrowth {
  bool rarely = false;  ///< only by kWorthAFactor or more; else they stay, but for rejected ones
  double most = 6;
};
/// Matrices that a method has factored and keeps hold for steps of one length.
inline constexpr double kWorthAFactor = 2;
StepGrowth growth_of(const Integrator& method, const Model& model);

/// The next step after one of h that made an error, in tolerances. order: of the estimate. last_error: of the
/// step before it, 0 where there was none. rejected: whether the step is to be taken again, or was so. most:
/// times h that it is at most.
double next_step(double h, double error, double last_error, int order, bool rejected, double most);

/// Returns the length of a first step at the state, s. order: of the error estimate of the method. step.work
/// is storage; its contents are ignored.
double first_step(StepContext& step, const ErrorScale& scale, int order);

/// Takes a step from a state, whose h is the first it tries, which ends at a time at the latest and then
/// exactly there. attempt(): takes the step in the state, returns its StepError. False when the step would
/// have to be shorter than `least`.
template <class Attempt>
bool take_controlled_step(State& state, double end, double least, StepGrowth growth, StepCounters& counters,
                          Attempt&& attempt) {
  constexpr double kNearEnd = 0.99;  // a step that comes so near to the end goes there
  const State begun = state;
  const double now = begun.time();
  bool rejected = false;
  for (double h = begun.h;;) {
    const bool last = h > kNearEnd * (end - now);
    const double taken = last ? end - now : h;
    state = begun;
    state.start = now;
    state.step = 0;
    state.h = taken;
    if (taken <= least && !last) return false;
    const auto [error, order, length] = attempt();
    const double tried = error <= 1 ? taken : length;  // one that was too wrong was so in what it came to
    double next =
        next_step(tried, error, rejected ? 0 : begun.error, order, rejected || !(error <= 1), growth.most);
    if (error <= 1 && growth.rarely && next < kWorthAFactor * taken) next = taken;
    if (error <= 1) {
      const bool cut = length < taken;
      state.start = last && !cut ? end : now + length;
      state.h = cut ? h : last ? std::max(h, next) : next;  // one that was cut short says little of the next
      state.error = error;
      return true;
    }
    h = next;
    rejected = true;
    ++counters.rejected;
  }
}

}  // namespace pliant
