// The error of steps with resting contacts by step doubling, and Richardson extrapolation.
#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/body/advance.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/contact/impact_timing.h>
#include <pliant/contact/longest_contact_step.h>
#include <pliant/math/index.h>
#include <pliant/project/project.h>

#include <pliant/contact/contact_pairs.h>
#include "touched_parts.h"

namespace pliant {

namespace {

/// Resting bodies that move less than this in a step, in tolerances, have no error of contact.
constexpr double kAtRestTolerance = 1e-2;

/// A step and its halves may strike, or change contact points, at different times. If one of them has and the
/// other has not, the rates differ by a jump, however short the step is: more than the change by gravity in
/// this many steps. Then only the displacement in the step counts, in steps no longer than those of
/// uncontrolled contact.
constexpr double kJumpInFalls = 0.6;
/// In shorter steps, s, only the displacement by differences of velocities counts.
constexpr double kBriefStep = 2e-5;

/// Returns whether the rates of some part differ by more than `most`, m/s.
bool jump(const Model& model, const VecX<double>& of_v, double most) {
  return std::any_of(model.parts().begin(), model.parts().end(), [&](const PartModel& m) {
    return m.q0 >= 0 &&
           std::max(of_v.segment<3>(m.v0).norm(), m.part->size() * of_v.segment<3>(m.v0 + 3).norm()) > most;
  });
}

/// Returns gravity, m/s^2, on the velocities of parts that lost a resting contact.
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

/// Returns whether a touching part, or one tied to it, is kinematic: equal positions at both ends of a step
/// do not mean that it was at rest.
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

/// Returns whether a step moved the parts by less than the allowed error.
bool rest(const Model& model, const ErrorScale& scale, const std::vector<int>& parts, const State& begun,
          const State& state) {
  VecX<double> of_q = VecX<double>::Zero(state.q.size()), of_v = VecX<double>::Zero(state.v.size());
  for (const int i : parts) {
    const PartModel& m = model.parts()[at(i)];
    of_q.segment(m.q0, m.n_q()) = state.q.segment(m.q0, m.n_q()) - begun.q.segment(m.q0, m.n_q());
    of_v.segment(m.v0, m.n_v()) = state.v.segment(m.v0, m.n_v()) - begun.v.segment(m.v0, m.n_v());
  }
  return scale.norm(of_q, of_v, state.v) <= kAtRestTolerance;
}

}  // namespace

bool ContactStepping::few_resting() const {
  return few_parts_ && std::none_of(record_.contacts.begin(), record_.contacts.end(),
                                    [](const Contact& c) { return c.a.at_nodes() || c.b.at_nodes(); });
}

StepError ContactStepping::step_by_doubling(Integrator& method, StepContext& step, const ErrorScale& scale,
                                            const State& begun, double length, long impacts) {
  constexpr int order = 1;
  const Model& model = dynamics_.model();
  State& state = step.state;
  std::vector<Contact> touching = rested_;
  touching.insert(touching.end(), record_.contacts.begin(), record_.contacts.end());
  if (!anything_moved(model, touching) && rest(model, scale, parts_touched(model, touching), begun, state))
    return {0, order, length};
  const Whole whole{state, length, rested_, record_.contacts.size(), step.counters.impacts > impacts};
  step.counters.impacts = impacts;
  undo_step();
  begin_step();
  state = begun;
  const Halves halves = take_halves(method, step, whole, begun);
  const double of_method = method.take_error();
  if (!halves.finite || !(of_method <= 1))
    return {std::numeric_limits<double>::infinity(), order, halves.taken};
  const bool struck = step.counters.impacts > impacts;
  const bool alike = agree(whole, halves, struck, state);
  const double of_ends = difference(whole, halves, alike, scale, begun.time(), state);
  const double error = std::max(of_ends, of_method);
  if (alike && !whole.struck && error <= 1) {
    StepContext at_end(dynamics_, state, step.work, step.counters, begun.time() + halves.taken, halves.taken);
    extrapolate(at_end, whole.state, halves.first_contacts);
  }
  return {error, order, halves.taken};
}

/// Takes the step again from `begun`, in the state, as two halves.
ContactStepping::Halves ContactStepping::take_halves(Integrator& method, StepContext& step,
                                                     const Whole& whole, const State& begun) {
  State& state = step.state;
  const double start = begun.time(), half = 0.5 * whole.length;
  auto advance_by = [&](double into, double h) {
    set_step(state, start + into, h);
    StepContext part(dynamics_, state, step.work, step.counters);
    return this->step(method, part, true);
  };
  Halves halves;
  halves.first = halves.taken = advance_by(0, half);
  halves.first_contacts = record_.contacts.size();
  halves.falls =
      whole.length * gravity_on_lost(dynamics_.model(), resting_, whole.rested, record_.contacts, start);
  rested_.clear();
  meets_late_ = false;
  auto finite = [&] { return state.q.allFinite() && state.v.allFinite(); };
  halves.finite = finite();
  if (halves.finite) {
    const double end = whole.struck && halves.first == half ? begun.h : whole.length;
    halves.taken = halves.first + advance_by(halves.first, end - halves.first);
    halves.finite = finite();
  }
  state.start = begun.start;
  state.step = begun.step;
  state.h = begun.h;
  return halves;
}

/// Whether the whole step and its halves met the same things. struck: whether the halves ended at an impact.
bool ContactStepping::agree(const Whole& whole, const Halves& halves, bool struck, const State& state) const {
  return halves.first == 0.5 * whole.length && struck == whole.struck &&
         (whole.struck || halves.taken == whole.length) && state.at_limit == whole.state.at_limit &&
         state.joints == whole.state.joints && same_sleepers(state.at_rest, whole.state.at_rest) &&
         record_.contacts.size() - halves.first_contacts == whole.contacts &&
         (whole.struck || halves.first_contacts == whole.contacts);
}

/// Returns the difference between the whole step and its halves, in tolerances.
double ContactStepping::difference(const Whole& whole, const Halves& halves, bool alike,
                                   const ErrorScale& scale, double start, const State& state) const {
  const Model& model = dynamics_.model();
  const double length = whole.length;
  const VecX<double> of_v = state.v - whole.state.v, none = VecX<double>::Zero(state.q.size());
  VecX<double> rate;
  dynamics_.coordinate_rates(whole.state.q, whole.state.v, rate);
  const VecX<double> of_q = state.q - whole.state.q - (halves.taken - length) * rate;
  const double jump_speed = kJumpInFalls * length * model.body().gravity_at(start).norm();
  const bool jumps = !alike && jump(model, of_v, jump_speed);
  // The displacement by a difference of velocities in the step.
  auto displacement = [&](const VecX<double>& v) {
    dynamics_.coordinate_rates(state.q, v, rate);
    return scale.norm(length * rate);
  };
  const bool brief = length <= kBriefStep,
             late = brief || (jumps && length <= longest_contact_step(ContactSettings{}, scale.tolerance()));
  const double of_ends =
                   late ? std::max(scale.norm(of_q), displacement(of_v)) : scale.norm(of_q, of_v, state.v),
               of_lost = brief ? displacement(halves.falls) : scale.norm(none, halves.falls, state.v);
  return std::max(of_ends, of_lost);
}

/// Extrapolates the state, to which two halves of a step led, by Richardson. once: the state to which the
/// whole step led. second: the number of the first contact of the second half in the record.
void ContactStepping::extrapolate(StepContext& step, const State& once, std::size_t second) {
  const Model& model = dynamics_.model();
  State& state = step.state;
  const double t = step.t;
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
  resolution_.reconcile(step, parts);
  project_limits(step);
  // Gaps are not linear in the extrapolated coordinates: the residual counts as resting.
  for (std::size_t k = second; k < record_.contacts.size(); ++k) {
    const Contact& contact = record_.contacts[k];
    if (!(record_.impulses[k].dot(contact.normal) > 0)) continue;
    const double opens = finder_.velocity(state, contact).dot(contact.normal),
                 gap = finder_.least_gap(state, t, contact, smaller_size(model, contact));
    state.contact_residual = std::max({state.contact_residual, std::abs(opens), gap / step.h});
  }
  // Energies are not linear either.
  state.work[static_cast<int>(Work::contact)] += energy_of(state) - energy - (state.work.sum() - booked);
}

}  // namespace pliant
