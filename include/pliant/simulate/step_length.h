// Length of steps with error control (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
// section II.4; the proportional-integral controller of Gustafsson 1991). take_controlled_step() accepts a
// step or repeats it shorter.
#pragma once

#include <algorithm>
#include <limits>

#include <pliant/method/integrator.h>
#include <pliant/method/step_error.h>

namespace pliant {

/// Limits of the growth from one step to the next.
struct StepGrowth {
  bool rarely = false;  ///< grow only by kWorthAFactor or more
  double most = 6;
};
/// Growth that is worth a new factorisation, for methods that keep factors for one step length.
inline constexpr double kWorthAFactor = 2;
StepGrowth growth_of(const Integrator& method, const Model& model);

/// Returns the length of the step after one of length h with this error, in tolerances. order: of the error
/// estimate. last_error: of the step before, 0 if there was none. rejected: whether the step is repeated or
/// was repeated. most: largest growth factor.
double next_step(double h, double error, double last_error, int order, bool rejected, double most);

/// Returns the length of a first step at the state, s. order: of the error estimate of the method. step.work
/// is storage; its contents are ignored.
double first_step(StepContext& step, const ErrorScale& scale, int order);

/// Takes a step from a state, which ends at `end` at the latest: tries the length in the state, and shorter
/// ones until the error is at most 1 tolerance. attempt(): takes the step in the state and returns its
/// StepError. Returns false if the step would have to be shorter than `least`.
template <class Attempt>
bool take_controlled_step(State& state, double end, double least, StepGrowth growth, StepCounters& counters,
                          Attempt&& attempt) {
  constexpr double kNearEnd = 0.99;  // a step that ends this near to `end` is extended to it
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
    const double tried = error <= 1 ? taken : length;  // the error is that of the length reached
    double next =
        next_step(tried, error, rejected ? 0 : begun.error, order, rejected || !(error <= 1), growth.most);
    if (error <= 1 && growth.rarely && next < kWorthAFactor * taken) next = taken;
    if (error <= 1) {
      const bool cut = length < taken;
      state.start = last && !cut ? end : now + length;
      state.h = cut ? h : last ? std::max(h, next) : next;  // a step that an event cut keeps its length
      state.error = error;
      return true;
    }
    h = next;
    rejected = true;
    ++counters.rejected;
  }
}

}  // namespace pliant
