// How long steps are whose errors are controlled (Hairer, Norsett & Wanner, Solving Ordinary Differential
// Equations I, section II.4; the proportional-integral rule of Gustafsson 1991).
#pragma once

#include <algorithm>
#include <limits>

#include <pliant/integrate/integrator.h>

namespace pliant {

/// The next step after one of h that made an error, in tolerances. order: of the estimate. last_error: of the
/// step before it, 0 where there was none. rejected: whether the step is to be taken again, or was so.
double next_step(double h, double error, double last_error, int order, bool rejected);

/// A first step at a state. work: any.
double first_step(const Dynamics& dynamics, const ErrorScale& scale, int order, const State& state,
                  Workspace<double>& work, StepCounters& counters);

/// How wrong a step is, in tolerances, not a finite number where it failed, and the order of that estimate.
struct StepError {
  double error;
  int order;
  double length;  ///< of the step as it was taken, s: it may have ended where bodies met
};

/// The least that steps grow by, where they do: the matrices that a method has factored hold for steps of one
/// length.
inline double least_growth(const Integrator& method) {
  return method.local_is_implicit() ? 1.5 : 1;
}

/// Takes a step from a state, whose h is the first it tries, which ends at a time at the latest and then
/// exactly there. attempt(): takes the step in the state, returns its StepError. growth: the next one is as
/// long, unless it may be so many times longer. False when the step would have to be shorter than `least`.
template <class Attempt>
bool take_controlled_step(State& state, double end, double least, double growth, StepCounters& counters,
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
    double next = next_step(taken, error, rejected ? 0 : begun.error, order, rejected || !(error <= 1));
    if (next > taken && next < growth * taken) next = taken;
    if (error <= 1) {
      const bool cut = length < taken;
      state.start = last && !cut ? end : now + length;
      state.h = last || cut ? std::max(h, next) : next;  // one that was cut short says little about the next
      state.error = error;
      return true;
    }
    h = next;
    rejected = true;
    ++counters.rejected;
  }
}

}  // namespace pliant
