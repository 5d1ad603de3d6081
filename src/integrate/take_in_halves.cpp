// The error of steps in which bodies lie on each other, and what is left of it.
#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/integrate/advance.h>
#include <pliant/integrate/contact_step.h>
#include <pliant/integrate/contact_stepping.h>
#include <pliant/integrate/impact_timing.h>
#include <pliant/math/index.h>

#include "contact_pairs.h"
#include "pushed_parts.h"

namespace pliant {

namespace {

/// What lies on each other and moves by less than this in a step, in tolerances, is at rest: that is exact.
constexpr double kAtRest = 1e-2;

/// Where one way has struck, or touches at other points, and the other has not yet, rates differ however
/// short the step is, by more than gravity would change them in so many steps: in steps no longer than those
/// of contact that is not controlled that counts by where it leads in the step.
constexpr double kFalls = 0.6;
/// In steps that are shorter than this share of the longest of these it does in any case.
constexpr double kBrief = 1e-2;

/// Whether rates of some part differ by more than so much, m/s.
bool jump(const Model& model, const VecX<double>& of_v, double most) {
  return std::any_of(model.parts().begin(), model.parts().end(), [&](const PartModel& m) {
    return m.q0 >= 0 &&
           std::max(of_v.segment<3>(m.v0).norm(), m.part->size() * of_v.segment<3>(m.v0 + 3).norm()) > most;
  });
}

/// Gravity, m/s^2, as it acts on the velocities of parts that lay on something which they do not touch now.
VecX<double> gravity_on_lost(const Model& model, const RestingContacts& resting,
                             const std::vector<Contact>& lay, std::vector<Contact> now, double t) {
  now.erase(std::remove_if(now.begin(), now.end(), [&](const Contact& c) { return c.gap > resting.gap(c); }),
            now.end());
  const Pairs held(now);
  VecX<double> gravity = VecX<double>::Zero(model.n_v());
  for (const Contact& contact : lay)
    for (const ContactSide* side : {&contact.a, &contact.b}) {
      if (side->part < 0 || held.has(contact)) continue;
      const PartModel& m = model.parts()[at(side->part)];
      if (m.q0 >= 0) gravity.segment<3>(m.v0) = model.body().gravity_at(t);
    }
  return gravity;
}

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
  const Model& model = dynamics_.model();
  std::vector<Contact> lie = lay_;
  lie.insert(lie.end(), record_.contacts.begin(), record_.contacts.end());
  if (rest(model, scale, parts_touched(model, lie), begun, state)) return {0, order, length};
  const State once = state;
  const std::vector<Contact> lay = lay_;
  const std::size_t touched = record_.contacts.size();
  const bool struck = counters.impacts > impacts;
  counters.impacts = impacts;
  undo_step();
  begin_step();
  state = begun;
  const double start = begun.time(), half = 0.5 * length;
  auto go = [&](double into, double h) {
    set_step(state, start + into, h);
    return step(method, state, work, counters, true);
  };
  const double first = go(0, half);
  const std::size_t touched_first = record_.contacts.size();
  const VecX<double> falls = length * gravity_on_lost(model, resting_, lay, record_.contacts, start);
  const double taken = first + go(first, (struck && first == half ? begun.h : length) - first);
  const bool strikes = counters.impacts > impacts;
  const bool alike = first == half && strikes == struck && state.at_limit == once.at_limit &&
                     state.joints == once.joints && record_.contacts.size() - touched_first == touched &&
                     (struck || touched_first == touched);
  const VecX<double> of_v = state.v - once.v;
  VecX<double> rate;
  dynamics_.coordinate_rates(once.q, once.v, rate);
  const VecX<double> of_q = state.q - once.q - (taken - length) * rate;
  double error = scale.norm(of_q, of_v, state.v);
  const ContactSettings& settings = model.body().contact;
  const double longest = longest_contact_step(settings, scale.tolerance());
  const bool jumps = !alike && jump(model, of_v, kFalls * length * model.body().gravity_at(start).norm());
  if (length <= (jumps ? longest : kBrief * settings.longest_step)) {
    dynamics_.coordinate_rates(state.q, of_v, rate);
    error = std::max(scale.norm(of_q), scale.norm(length * rate));
  }
  error = std::max(error, scale.norm(VecX<double>::Zero(state.q.size()), falls, state.v));
  if (!state.q.allFinite() || !state.v.allFinite()) error = std::numeric_limits<double>::infinity();
  if (alike && !struck && error <= 1)
    extrapolate(once, touched_first, start + taken, taken, state, work, counters);
  state.start = begun.start;
  state.step = begun.step;
  state.h = begun.h;
  return {std::max(error, method.take_error()), order, taken};
}

/// once: where a step of h seconds to a time t (s) led; state: where its halves did, and then what both tell
/// of shorter ones. second: the number of the first contact of the second half in the record.
void ContactStepping::extrapolate(const State& once, std::size_t second, double t, double h, State& state,
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
  // Gaps are not linear in what was extrapolated: what is left of them counts as resting.
  for (std::size_t k = second; k < record_.contacts.size(); ++k) {
    const Contact& contact = record_.contacts[k];
    if (!(record_.impulses[k].dot(contact.normal) > 0)) continue;
    const double opens = finder_.velocity(state, contact).dot(contact.normal),
                 gap = finder_.least_gap(state, t, contact, smaller_size(model, contact));
    state.contact_residual = std::max({state.contact_residual, std::abs(opens), gap / h});
  }
  // Nor are energies.
  state.work[static_cast<int>(Work::contact)] += energy_of(state) - energy - (state.work.sum() - booked);
}

}  // namespace pliant
