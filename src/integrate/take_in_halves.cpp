// The error of steps in which bodies lie on each other, and what is left of it.
#include <algorithm>
#include <cmath>

#include <pliant/integrate/advance.h>
#include <pliant/integrate/contact_stepping.h>
#include <pliant/integrate/impact_timing.h>
#include <pliant/math/index.h>

#include "pushed_parts.h"

namespace pliant {

namespace {

/// What lies on each other and moves by less than this in a step, in tolerances, is at rest: that is exact.
constexpr double kAtRest = 1e-2;

/// In steps of this share of the longest of contact what strikes at the same points of bodies that touch
/// already, which is not told in time, counts as that does which strikes in one way and not yet in the other.
constexpr double kBrief = 1e-2;

/// Whether a step did to parts less than its error may be.
bool rest(const Model& model, const ErrorScale& scale, const std::vector<int>& parts, const State& begun,
          const State& state) {
  VecX<double> of_q = VecX<double>::Zero(state.q.size()), of_v = VecX<double>::Zero(state.v.size());
  for (const int i : parts) {
    const PartModel& m = model.parts()[at(i)];
    of_q.segment(m.q0, m.n_q()) = state.q.segment(m.q0, m.n_q()) - begun.q.segment(m.q0, m.n_q());
    of_v.segment(m.v0, m.n_v()) = state.v.segment(m.v0, m.n_v()) - begun.v.segment(m.v0, m.n_v());
  }
  return scale.norm(of_q, of_v, state.v) <= kAtRest;
}

}  // namespace

bool ContactStepping::few_last() const {
  return few_parts_ && std::none_of(record_.contacts.begin(), record_.contacts.end(),
                                    [](const Contact& c) { return c.a.at_nodes() || c.b.at_nodes(); });
}

StepError ContactStepping::take_in_halves(Integrator& method, const ErrorScale& scale, const State& begun,
                                          double length, long impacts, State& state, Workspace<double>& work,
                                          StepCounters& counters) {
  constexpr int order = 1;
  if (rest(dynamics_.model(), scale, parts_touched(dynamics_.model(), record_.contacts), begun, state))
    return {0, order, length};
  const State once = state;
  const bool struck = counters.impacts > impacts;
  counters.impacts = impacts;
  undo_step();
  begin_step();
  state = begun;
  const double start = begun.time();
  auto go = [&](double into, double h) {
    set_step(state, start + into, h);
    return step(method, state, work, counters, true);
  };
  const double half = 0.5 * length, first = go(0, half),
               taken = first + go(first, (struck && first == half ? begun.h : length) - first);
  const bool strikes = counters.impacts > impacts;
  VecX<double> of_v = state.v - once.v, rate, of_q;
  dynamics_.coordinate_rates(once.q, once.v, rate);
  of_q = state.q - once.q - (taken - length) * rate;
  double error = scale.norm(of_q, of_v, state.v);
  const bool alike =
      first == half && strikes == struck && state.at_limit == once.at_limit && state.joints == once.joints;
  if (!alike || length <= kBrief * dynamics_.model().body().contact.longest_step) {
    // What struck in one and not yet in the other makes rates differ however short the step is: it counts by
    // where that leads in the step.
    dynamics_.coordinate_rates(state.q, of_v, rate);
    error = std::max(scale.norm(of_q), scale.norm(length * rate));
  }
  if (alike && !struck && error <= 1) {
    extrapolate(once, start + taken, taken, state, work, counters);
  }
  state.start = begun.start;
  state.step = begun.step;
  state.h = begun.h;
  return {std::max(error, method.take_error()), order, taken};
}

/// once: where a step to time t (s) led; state: where its halves did, and then what both tell of shorter
/// ones.
void ContactStepping::extrapolate(const State& once, double t, double h, State& state,
                                  Workspace<double>& work, StepCounters& counters) {
  const Model& model = dynamics_.model();
  const std::vector<int> parts = parts_touched(model, record_.contacts);
  auto energy_of = [&](const State& of) { return dynamics_.energy(t, of.q, of.v, parts, scratch_); };
  const double energy = 2 * energy_of(state) - energy_of(once);
  state.work += state.work - once.work;
  const double booked = state.work.sum();
  for (const int i : parts) {
    const PartModel& m = model.parts()[at(i)];
    state.q.segment(m.q0, m.n_q()) += state.q.segment(m.q0, m.n_q()) - once.q.segment(m.q0, m.n_q());
    state.v.segment(m.v0, m.n_v()) += state.v.segment(m.v0, m.n_v()) - once.v.segment(m.v0, m.n_v());
  }
  normalise_rotations(model, state.q);
  settling_.reconcile(parts, state, t, work, counters);
  // Neither are gaps, nor energies, linear in what was extrapolated.
  for (std::size_t k = 0; k < record_.contacts.size(); ++k) {
    const Contact& contact = record_.contacts[k];
    if (!(record_.impulses[k].dot(contact.normal) > 0)) continue;
    const double opens = finder_.velocity(state, contact).dot(contact.normal),
                 gap = finder_.least_gap(state, t, contact, smaller_size(model, contact));
    state.contact_residual = std::max({state.contact_residual, std::abs(opens), gap / h});
  }
  state.work[static_cast<int>(Work::contact)] += energy_of(state) - energy - (state.work.sum() - booked);
}

}  // namespace pliant
