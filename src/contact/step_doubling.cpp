// The error of steps in which bodies lie on each other, and what is left of it.
#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/body/advance.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/contact/impact_timing.h>
#include <pliant/contact/longest_contact_step.h>
#include <pliant/math/index.h>
#include <pliant/project/project.h>

#include "contact_pairs.h"
#include "touched_parts.h"

namespace pliant {

namespace {

/// What lies on each other and moves by less than this in a step, in tolerances, is at rest: that is exact.
constexpr double kAtRest = 1e-2;

/// A step and its halves tell that something struck, or that bodies touch at other points, at times that
/// differ: if one of them has and the other has not yet, rates jump between them however short the step is.
/// They jump where they differ by more than gravity changes them in so many steps; what counts is then where
/// that leads in the step, in steps no longer than those of contact that is not controlled.
constexpr double kFalls = 0.6;
/// In steps as short as this, s, it is what counts in any case.
constexpr double kBrief = 2e-5;

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

/// Whether hands move what touches, or the parts that are tied to it: what is the same at both ends of a step
/// may have been elsewhere.
bool anything_moved(const Model& model, const std::vector<Contact>& touch) {
  auto moves = [&](const ContactSide& side) {
    return side.part >= 0 && model.parts()[at(side.part)].motion != nullptr;
  };
  return std::any_of(touch.begin(), touch.end(),
                     [&](const Contact& c) {
                       return moves(c.a) || moves(c.b) ||
                              (c.plane >= 0 && !model.body().contact.planes[at(c.plane)].point.is_constant());
                     }) ||
         are_driven(model, parts_touched(model, touch));
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

bool ContactStepping::few_resting() const {
  return few_parts_ && std::none_of(record_.contacts.begin(), record_.contacts.end(),
                                    [](const Contact& c) { return c.a.at_nodes() || c.b.at_nodes(); });
}

StepError ContactStepping::step_by_doubling(Integrator& method, const ErrorScale& scale, const State& begun,
                                            double length, long impacts, State& state,
                                            Workspace<double>& work, StepCounters& counters) {
  constexpr int order = 1;
  const Model& model = dynamics_.model();
  const std::vector<Contact> lay = rested_;
  std::vector<Contact> touch = lay;
  touch.insert(touch.end(), record_.contacts.begin(), record_.contacts.end());
  if (!anything_moved(model, touch) && rest(model, scale, parts_touched(model, touch), begun, state))
    return {0, order, length};
  const State once = state;
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
  rested_.clear();
  meets_late_ = false;
  const bool finite = state.q.allFinite() && state.v.allFinite();
  const double taken =
      finite ? first + go(first, (struck && first == half ? begun.h : length) - first) : first;
  state.start = begun.start;
  state.step = begun.step;
  state.h = begun.h;
  const double of_method = method.take_error();
  if (!finite || !state.q.allFinite() || !state.v.allFinite() || !(of_method <= 1))
    return {std::numeric_limits<double>::infinity(), order, taken};
  const bool strikes = counters.impacts > impacts;
  const bool alike =
      first == half && strikes == struck && (struck || taken == length) && state.at_limit == once.at_limit &&
      state.joints == once.joints && same_sleepers(state.at_rest, once.at_rest) &&
      record_.contacts.size() - touched_first == touched && (struck || touched_first == touched);
  const VecX<double> of_v = state.v - once.v, none = VecX<double>::Zero(state.q.size());
  VecX<double> rate;
  dynamics_.coordinate_rates(once.q, once.v, rate);
  const VecX<double> of_q = state.q - once.q - (taken - length) * rate;
  const bool jumps = !alike && jump(model, of_v, kFalls * length * model.body().gravity_at(start).norm());
  // Of rates where they lead in the step.
  auto led_by = [&](const VecX<double>& rates) {
    dynamics_.coordinate_rates(state.q, rates, rate);
    return scale.norm(length * rate);
  };
  const bool brief = length <= kBrief,
             late = brief || (jumps && length <= longest_contact_step(ContactSettings{}, scale.tolerance()));
  const double of_ends = late ? std::max(scale.norm(of_q), led_by(of_v)) : scale.norm(of_q, of_v, state.v),
               of_lost = brief ? led_by(falls) : scale.norm(none, falls, state.v);
  const double error = std::max({of_ends, of_lost, of_method});
  if (alike && !struck && error <= 1)
    extrapolate(once, touched_first, start + taken, taken, state, work, counters);
  return {error, order, taken};
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
  resolution_.reconcile(parts, state, t, work, counters);
  project_limits(dynamics_, t, state, work, counters);
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
