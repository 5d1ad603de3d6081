// Step doubling: a step with resting or unlocated contacts is repeated as two half steps. The difference of
// both results gives the error. If both agree, Richardson extrapolation combines them. Function bodies of
// contact_stepping.h.
#pragma once

#include <pliant/body/speed_scale.h>
#include <pliant/contact/contact_stepping.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/body/advance.h>
#include <pliant/body/stages/part_stages.h>
#include <pliant/body/step_failure.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/impact_timing.h>
#include <pliant/contact/longest_contact_step.h>
#include <pliant/contact/touched_parts.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/project/project.h>

namespace pliant {

namespace step_doubling {

/// Bodies in contact whose state changes by at most this in a step, in tolerances, are at rest: the error of
/// the step is zero. Bodies with prescribed motion (has_prescribed_motion()) are an exception.
inline constexpr double kAtRestTolerance = 1e-2;

/// The whole step and its halves resolve an impact, or a change of contact points, at different times. If one
/// of them has resolved it and the other has not, the velocities differ by a jump, however short the step is.
/// A difference is a jump if the results do not agree (agree()) and it exceeds this multiple of the speed
/// that gravity gives a body in the step. Then the error is measured by the displacement that the jump causes
/// in the step, if the step, times slow_rate(), is at most longest_contact_step() with the default settings.
inline constexpr double kJumpInGravity = 0.6;
/// A gap above this multiple of the largest gap of a resting contact is not left by a step: the contact has
/// opened.
inline constexpr double kMaxLeftGap = 1000;
/// In steps up to this length, times slow_rate(), the error is always measured by the displacement.
inline constexpr double kBriefStep = 2e-5;

/// Returns whether the linear velocity of a part, or its angular velocity times its size, differs by more
/// than max_speed, m/s. dv: differences of the velocities of all parts.
inline bool has_jump(const Model& model, const VecX<double>& dv, double max_speed) {
  return std::any_of(model.parts().begin(), model.parts().end(), [&](const PartModel& m) {
    return m.q0 >= 0 &&
           std::max(dv.segment<3>(m.v0).norm(), m.part->size() * dv.segment<3>(m.v0 + 3).norm()) > max_speed;
  });
}

/// Returns the acceleration by gravity, m/s^2, of both parts of each resting pair that has lost all its
/// contacts, and zero for other parts; n_v numbers. before: contacts that rested in the whole step; now:
/// contacts that its first half has resolved. t: time, s.
inline VecX<double> gravity_after_loss(const Model& model, const RestingContacts& resting,
                                       const std::vector<Contact>& before, std::vector<Contact> now,
                                       double t) {
  now.erase(std::remove_if(now.begin(), now.end(), [&](const Contact& c) { return c.gap > resting.gap(c); }),
            now.end());
  const Pairs touching(now);
  VecX<double> gravity = VecX<double>::Zero(model.n_v());
  for (const Contact& contact : before)
    for (const ContactSide* side : {&contact.a, &contact.b}) {
      if (side->part < 0 || touching.has(contact)) continue;
      const PartModel& m = model.parts()[at(side->part)];
      if (m.q0 >= 0) gravity.segment<3>(m.v0) = model.body().gravity_at(t);
    }
  return gravity;
}

/// Returns the linear momenta, kg m/s, world, of those parts of a list that deform locally. work: the last
/// evaluation of these parts.
inline std::vector<Vec3<double>> local_momenta(const Model& model, const std::vector<int>& parts,
                                               const Workspace<double>& work) {
  std::vector<Vec3<double>> momenta;
  for (const int i : parts) {
    const PartModel& m = model.parts()[at(i)];
    const PartWorkspace<double>& w = work.parts[at(i)];
    if (m.local != nullptr) momenta.push_back(w.R * detail::local_motion(m, w).momentum);
  }
  return momenta;
}

/// Returns whether parts were at rest in a step: their states at its start (initial) and at its end (state)
/// differ by at most kAtRestTolerance.
inline bool were_at_rest(const Model& model, const ErrorScale& scale, const std::vector<int>& parts,
                         const State& initial, const State& state) {
  VecX<double> dq = VecX<double>::Zero(state.q.size()), dv = VecX<double>::Zero(state.v.size());
  for (const int i : parts) {
    const PartModel& m = model.parts()[at(i)];
    dq.segment(m.q0, m.n_q()) = state.q.segment(m.q0, m.n_q()) - initial.q.segment(m.q0, m.n_q());
    dv.segment(m.v0, m.n_v()) = state.v.segment(m.v0, m.n_v()) - initial.v.segment(m.v0, m.n_v());
  }
  return scale.norm(dq, dv, state.v) <= kAtRestTolerance;
}

}  // namespace step_doubling

PLIANT_INLINE bool ContactStepping::may_double() const {
  return few_parts_ && std::all_of(record_.contacts.begin(), record_.contacts.end(),
                                   [&](const Contact& c) { return finder_.finds(c); });
}

PLIANT_INLINE StepError ContactStepping::step_by_doubling(Integrator& method, StepContext& step,
                                                          const ErrorScale& scale, const State& initial,
                                                          double length, const StepCounters& before) {
  constexpr int order = 1;
  const Model& model = dynamics_.model();
  State& state = step.state;
  std::vector<Contact> touching = resting_at_start_;
  touching.insert(touching.end(), record_.contacts.begin(), record_.contacts.end());
  if (!has_prescribed_motion(model, touching) &&
      step_doubling::were_at_rest(model, scale, parts_touched(model, touching), initial, state))
    return {0, order, length};
  const Whole whole{state, length, resting_at_start_, record_.contacts.size(),
                    step.counters.impacts > before.impacts || at_friction_event_};
  step.counters.impacts = before.impacts;
  step.counters.sequential_impacts = before.sequential_impacts;
  undo_step();
  begin_step();
  state = initial;
  const Halves halves = step_halves(method, step, whole, initial, scale.tolerance());
  const double method_error = method.pop_error();
  if (!halves.finite || !(method_error <= 1))
    return {std::numeric_limits<double>::infinity(), order, halves.length};
  const bool has_event = step.counters.impacts > before.impacts || at_friction_event_;
  const bool agreed = agree(whole, halves, has_event, state);
  const double contact_error = difference(whole, halves, agreed, scale, initial.time(), state);
  const double error = std::max(contact_error, method_error);
  if (agreed && !whole.has_event && error <= 1) {
    StepContext at_end(dynamics_, state, step.work, step.counters, initial.time() + halves.length,
                       halves.length);
    const std::vector<int> parts = parts_touched(model, record_.contacts);
    const auto balance_of = [&](const State& at) {
      return dynamics_.energy(at_end.t, at.q, at.v, parts, scratch_) - at.work.sum();
    };
    const double balance = 2 * balance_of(state) - balance_of(whole.state);
    extrapolate(at_end, whole.state, {whole.state, 1}, halves.first_contacts, parts);
    // Energies are not linear in the coordinates and velocities. Work::contact gets the difference.
    state.work[static_cast<int>(Work::contact)] += balance_of(state) - balance;
  }
  return {error, order, halves.length};
}

/// Repeats the step from `initial` as two halves; step.state is the state at their end.
PLIANT_INLINE ContactStepping::Halves ContactStepping::step_halves(Integrator& method, StepContext& step,
                                                                   const Whole& whole, const State& initial,
                                                                   double tolerance) {
  State& state = step.state;
  const double start = initial.time(), half = 0.5 * whole.length;
  auto advance_by = [&](double into, double h) {
    set_step(state, start + into, h);
    StepContext part(dynamics_, state, step.work, step.counters);
    return step_once(method, part, tolerance);
  };
  Halves halves;
  halves.first = halves.length = advance_by(0, half);
  halves.first_contacts = record_.contacts.size();
  halves.gravity_velocities =
      whole.length *
      step_doubling::gravity_after_loss(dynamics_.model(), resting_, whole.resting, record_.contacts, start);
  resting_at_start_.clear();
  has_unlocated_ = false;
  at_friction_event_ = false;
  auto finite = [&] { return state.q.allFinite() && state.v.allFinite(); };
  halves.finite = finite();
  if (halves.finite) {
    const double end = whole.has_event && halves.first == half ? initial.h : whole.length;
    halves.length = halves.first + advance_by(halves.first, end - halves.first);
    halves.finite = finite();
  }
  state.start = initial.start;
  state.step = initial.step;
  state.h = initial.h;
  return halves;
}

/// Returns whether the whole step and its halves have equal lengths, modes of joints, limits and sleep, and
/// numbers of contacts, and whether both or neither ended at an event. If both ended at an event, total
/// lengths and the contacts of the first half are not compared; the first half must still have its full
/// length. has_event: whether the halves ended at an event.
PLIANT_INLINE bool ContactStepping::agree(const Whole& whole, const Halves& halves, bool has_event,
                                          const State& state) const {
  return halves.first == 0.5 * whole.length && has_event == whole.has_event &&
         (whole.has_event || halves.length == whole.length) && state.at_limit == whole.state.at_limit &&
         state.joints == whole.state.joints && same_sleepers(state.at_rest, whole.state.at_rest) &&
         record_.contacts.size() - halves.first_contacts == whole.contacts &&
         (whole.has_event || halves.first_contacts == whole.contacts);
}

/// Returns the difference between the whole step and its halves, or the error by contacts that the first half
/// has lost, whichever is larger, in tolerances.
PLIANT_INLINE double ContactStepping::difference(const Whole& whole, const Halves& halves, bool agreed,
                                                 const ErrorScale& scale, double start,
                                                 const State& state) const {
  const Model& model = dynamics_.model();
  const double length = whole.length;
  const VecX<double> dv = state.v - whole.state.v, none = VecX<double>::Zero(state.q.size());
  VecX<double> rate;
  dynamics_.coordinate_rates(whole.state.q, whole.state.v, rate);
  const VecX<double> dq = state.q - whole.state.q - (halves.length - length) * rate;
  const double max_speed = step_doubling::kJumpInGravity * length * model.body().gravity_at(start).norm();
  const bool jumped = !agreed && step_doubling::has_jump(model, dv, max_speed);
  // Returns the displacement by a difference of velocities in the step.
  auto displacement = [&](const VecX<double>& v) {
    dynamics_.coordinate_rates(state.q, v, rate);
    return scale.norm(length * rate);
  };
  const double slow = slow_rate(model) * length;  // without unit
  const bool brief = slow <= step_doubling::kBriefStep,
             by_displacement =
                 brief || (jumped && slow <= longest_contact_step(ContactSettings{}, scale.tolerance()));
  const double end_error =
                   by_displacement ? std::max(scale.norm(dq), displacement(dv)) : scale.norm(dq, dv, state.v),
               loss_error = brief ? displacement(halves.gravity_velocities)
                                  : scale.norm(none, halves.gravity_velocities, state.v);
  return std::max(end_error, loss_error);
}

/// Includes in the residual of the state the gaps and the normal speeds of the contacts that have pushed,
/// from number `first` in the record on. Gaps are not linear in the coordinates, so that the displacement by
/// the impulses, and extrapolation, leave small gaps. Without them in the residual, the next step would take
/// these contacts for impacts. t: time of the state, s; h: length of the step, s.
PLIANT_INLINE void ContactStepping::include_openings(std::size_t first, double t, double h,
                                                     State& state) const {
  PairKey last{};
  double gap = 0;
  for (std::size_t k = first; k < record_.contacts.size(); ++k) {
    const Contact& contact = record_.contacts[k];
    if (!finder_.finds(contact)) continue;
    if (!(record_.impulses[k].dot(contact.normal) > 0) || contact.rebound > 0) continue;
    const double max_gap = step_doubling::kMaxLeftGap * resting_.tight_gap(contact);
    if (k == first || key_of(contact) != last) gap = finder_.min_gap(state, t, contact, max_gap);
    last = key_of(contact);
    const double opening = finder_.velocity(state, contact).dot(contact.normal);
    if (gap < max_gap)
      state.contact_residual = std::max({state.contact_residual, std::abs(opening), gap / h});
  }
}

/// Returns a copy of `halves`, the state at the end of the two halves. In it the coordinates and velocities
/// of some parts are halves + share (halves - coarse).
PLIANT_INLINE State ContactStepping::extrapolated(const State& halves, const Extrapolation& from,
                                                  const std::vector<int>& parts) const {
  State state = halves;
  for (const int i : parts) {
    const PartModel& m = dynamics_.model().parts()[at(i)];
    const auto move_on = [&](auto& x, const auto& coarse, int first, int n) {
      x.segment(first, n) += from.share * (x.segment(first, n) - coarse.segment(first, n));
    };
    move_on(state.q, from.coarse.q, m.q0, m.n_q());
    move_on(state.v, from.coarse.v, m.v0, m.n_v());
  }
  normalise_rotations(dynamics_.model(), state.q);
  return state;
}

/// Changes c_dot of the parts that deform locally so that their linear momenta are `momenta`, as of
/// local_momenta(). Momenta are extrapolated like velocities, but are not linear in the coordinates, and
/// nodes that keep the positions of the halves change them. t: time of the state, s.
PLIANT_INLINE void ContactStepping::keep_momenta(double t, const std::vector<Vec3<double>>& momenta,
                                                 const std::vector<int>& parts, State& state) {
  if (momenta.empty()) return;
  const Model& model = dynamics_.model();
  dynamics_.energy(t, state.q, state.v, parts, scratch_);
  const std::vector<Vec3<double>> now = step_doubling::local_momenta(model, parts, scratch_);
  std::size_t number = 0;
  for (const int i : parts) {
    const PartModel& m = model.parts()[at(i)];
    if (m.local == nullptr) continue;
    state.v.segment<3>(m.v0) += (momenta[number] - now[number]) / m.part->total_mass();
    ++number;
  }
}

/// Extrapolates the state of some parts, at the end of the two halves, by Richardson. whole: the state at the
/// end of the whole step. from: what extrapolated() gets. second: number of the first contact of the second
/// half in the record. Works are extrapolated, too. Energies are not linear in the coordinates and
/// velocities, so that the energy changes by more than the works.
PLIANT_INLINE void ContactStepping::extrapolate(StepContext& step, const State& whole,
                                                const Extrapolation& from, std::size_t second,
                                                const std::vector<int>& parts) {
  const Model& model = dynamics_.model();
  State& state = step.state;
  auto momenta_of = [&](const State& at_end) {
    dynamics_.evaluate_masses(step.t, at_end.q, at_end.v, parts, scratch_);
    return step_doubling::local_momenta(model, parts, scratch_);
  };
  const std::vector<Vec3<double>> of_whole = momenta_of(whole);
  std::vector<Vec3<double>> momenta = momenta_of(state);
  for (std::size_t i = 0; i < momenta.size(); ++i) momenta[i] += from.share * (momenta[i] - of_whole[i]);
  state = extrapolated(state, from, parts);
  state.work += from.share * (state.work - whole.work);
  project_frames(step, parts);
  keep_momenta(step.t, momenta, parts, state);
  project_joints(step);
  project_limits(step);
  include_openings(second, step.t, step.h, state);
}

}  // namespace pliant
