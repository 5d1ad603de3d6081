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
  bool rarely = false;  ///< the length grows by a factor of kMinRareGrowth or more, or not at all
  double max_growth = 6;
};
/// Smallest growth that is worth a new factorisation, for methods whose factors depend on the step length.
inline constexpr double kMinRareGrowth = 2;
/// Returns the limits for a method: growth by 2 to 40 if it reuses factors, which it does for parts whose
/// nodes have a constant stiffness and are integrated implicitly; otherwise the defaults.
StepGrowth growth_of(const Integrator& method, const Model& model);

/// Returns the length (s) of the step after a step of length h (s) with this error, in tolerances. order: of
/// the error estimate. last_error: of the step before, 0 if there was none. rejected: whether this step is
/// rejected, or repeats a rejected one. max_growth: largest growth factor.
double next_step(double h, double error, double last_error, int order, bool rejected, double max_growth);

/// Returns the length of a first step at the state, s. order: of the error estimate of the method. step.work
/// is scratch storage; its contents are ignored.
double first_step(StepContext& step, const ErrorScale& scale, int order);

/// Takes a step from a state, with the length in the state, which ends at the time `end` (s) at the latest.
/// Accepts the step if its error is at most 1 tolerance; otherwise rejects it, and repeats it shorter.
/// attempt(): advances the state by its h and returns the StepError. Returns false if the step would have to
/// be as short as min_length (s).
template <class Attempt>
bool take_controlled_step(State& state, double end, double min_length, StepGrowth growth,
                          StepCounters& counters, Attempt&& attempt) {
  constexpr double kNearEnd = 0.99;  // a step longer than this share of the time left until `end` ends there
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
