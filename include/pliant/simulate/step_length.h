// Length of steps with error control (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
// section II.4; the proportional-integral controller of Gustafsson 1991). take_controlled_step() accepts a
// step, or rejects it and repeats it with a shorter length.
#pragma once

#include <algorithm>
#include <limits>

#include <pliant/method/integrator.h>
#include <pliant/method/step_error.h>

namespace pliant {

/// Limits of the growth from one step to the next.
struct StepGrowth {
  bool rarely = false;    ///< the length grows by a factor of kMinRareGrowth or more, or not at all
  double max_growth = 6;  ///< largest ratio of a step length to the previous step length
};
/// Smallest growth that is worth a new factorisation, for methods whose factors depend on the step length.
inline constexpr double kMinRareGrowth = 2;
/// Returns the limits for a method and a model: growth by a factor from 2 to 40 if the method reuses factors,
/// otherwise the defaults. A method reuses factors if it integrates local elasticity implicitly and the model
/// has a part whose nodes have a constant stiffness.
StepGrowth growth_of(const Integrator& method, const Model& model);

/// Returns the length (s) of the step after a step of length h (s). error: error of this step divided by the
/// tolerance; if it is not finite, the result is 0.2 h. last_error: error of the previous step; 0 if there
/// was no previous step. order: order of the error estimate. rejected: whether this step is rejected, or
/// repeats a rejected step; the length then does not grow. max_growth: largest ratio of the result to h.
double next_step(double h, double error, double last_error, int order, bool rejected, double max_growth);

/// Returns the length of a first step at the state, s. order: order of the error estimate of the method.
/// step.work is scratch storage; its contents are ignored.
double first_step(StepContext& step, const ErrorScale& scale, int order);

/// Advances a state by one step of length state.h. The step ends at the time `end` (s) at the latest. If the
/// error of the step is at most 1 (in tolerances), accepts the step and stores the next length in state.h;
/// otherwise rejects the step and repeats it with a shorter length. attempt() advances the state by state.h
/// and returns the StepError. Returns true if a step was accepted. Returns false, with the state at the start
/// of the step, if the length would be min_length (s) or less and the step would not reach `end`.
template <class Attempt>
bool take_controlled_step(State& state, double end, double min_length, StepGrowth growth,
                          StepCounters& counters, Attempt&& attempt) {
  constexpr double kNearEnd = 0.99;  // a step longer than this share of the time to `end` ends at `end`
  const State start = state;
  const double now = start.time();
  bool rejected = false;
  for (double h = start.h;;) {
    const bool reaches_end = h > kNearEnd * (end - now);
    const double tried = reaches_end ? end - now : h;
    state = start;
    state.start = now;
    state.step = 0;
    state.h = tried;
    if (tried <= min_length && !reaches_end) return false;
    const auto [error, order, length] = attempt();
    const bool accepted = error <= 1;
    const double measured = accepted ? tried : length;  // length to which the error belongs
    double next = next_step(measured, error, rejected ? 0 : start.error, order, rejected || !accepted,
                            growth.max_growth);
    if (accepted && growth.rarely && next < kMinRareGrowth * tried) next = tried;
    if (accepted) {
      const bool cut = length < tried;
      state.start = reaches_end && !cut ? end : now + length;
      state.h = cut           ? h
                : reaches_end ? std::max(h, next)
                              : next;  // an event that cut the step does not change h
      state.error = error;
      return true;
    }
    h = next;
    rejected = true;
    ++counters.rejected;
  }
}

}  // namespace pliant
