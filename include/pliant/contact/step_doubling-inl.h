// Function bodies of contact_stepping.h: step doubling. A step with resting contacts, or with contacts whose
// time was not located, is repeated as two half steps, and with a small tolerance as three thirds, too. The
// difference of the results gives the error. If the results agree, Richardson extrapolation combines them.
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

/// The whole step and its halves resolve an impact, or a change of contact points, at different times. If
/// only one of both results includes the impact, the velocities differ by a jump, however short the step is.
/// A difference is a jump if the results do not agree (agree()) and the difference exceeds this multiple of
/// the speed that gravity gives a body in the step. Then the error is measured by the displacement that the
/// jump causes in the step, if slow_rate() times the length of the step is at most the number of seconds of
/// longest_contact_step() with the default settings.
inline constexpr double kJumpInGravity = 0.6;
/// A gap above this multiple of the largest gap of a resting contact is no error of a step: the contact has
/// opened.
inline constexpr double kMaxLeftGap = 1000;
/// With a tolerance below this, steps are repeated in thirds, too.
inline constexpr double kThirdsTolerance = 1e-4;
/// If slow_rate() times the length of a step is at most this, the error is always measured by displacements:
/// the difference of the positions, and the displacement that the difference of the velocities causes in the
/// step.
inline constexpr double kBriefStep = 2e-5;

/// Returns whether the linear velocity of a part, or its angular velocity times its size, differs by more
/// than max_speed, m/s. dv: differences of the velocities of all parts.
inline bool has_jump(const Model& model, const VecX<double>& dv, double max_speed) {
  return std::any_of(model.parts().begin(), model.parts().end(), [&](const PartModel& m) {
    return m.q0 >= 0 &&
           std::max(dv.segment<3>(m.v0).norm(), m.size * dv.segment<3>(m.v0 + 3).norm()) > max_speed;
  });
}

/// Returns the acceleration by gravity, m/s^2, of both parts of each resting pair that has lost all its
/// contacts, and zero for other parts; n_v numbers. before: contacts that rested in the whole step; now:
/// contacts that the first part of its repetition has resolved. t: time, s.
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

/// Repeats a step in thirds. Returns an error estimate of the extrapolation, O(h^3), in tolerances. If this
/// error is at most 1, extrapolates from the results T_1, T_2, T_3 of the whole step, its halves and its
/// thirds to
///   T = T_3 + 4 (T_3 - T_2) - (T_3 - T_1) / 2
/// (Hairer, Norsett and Wanner 1993, section II.9). The error is estimated as T - (2 T_2 - T_1). If the
/// thirds differ from the whole step in their events or contacts, nothing is extrapolated, and the error is
/// at least error_of_halves. before: the counters before the step.
PLIANT_INLINE StepError ContactStepping::step_by_thirds(Integrator& method, StepContext& step,
                                                        const ErrorScale& scale, const Whole& whole,
                                                        const State& initial, const StepCounters& before,
                                                        double error_of_halves) {
  State& state = step.state;
  const State halves = state;
  restart_step(step, initial, before);
  const Fractions thirds = step_fractions(3, method, step, whole, initial, scale.tolerance());
  const double method_error = method.pop_error();
  if (!thirds.finite || !(method_error <= 1))
    return {std::numeric_limits<double>::infinity(), 1, thirds.length};
  if (!agree(whole, thirds, has_event(step, before), state)) {
    const double difference_of_thirds = difference(whole, thirds, false, scale, initial.time(), state);
    return {std::max({error_of_halves, method_error, difference_of_thirds}), 1, thirds.length};
  }
  const auto change = [&](const auto& t_1, const auto& t_2, const auto& t_3) {
    return VecX<double>(4.5 * t_3 - 6 * t_2 + 1.5 * t_1);
  };
  const Difference from_halves{change(whole.state.q, halves.q, state.q),
                               change(whole.state.v, halves.v, state.v)};
  const double error =
      std::max(method_error, measure(from_halves, whole.length, thirds, false, scale, state));
  if (error <= 1)
    extrapolate_rigid(step, {{halves, 4, halves}, {whole.state, -0.5, whole.state}}, thirds, initial);
  return {error, 2, whole.length};
}

/// Restores the record and the state at the start of a step that is to be repeated. initial: this state.
PLIANT_INLINE void ContactStepping::restart_step(StepContext& step, const State& initial,
                                                 const StepCounters& before) {
  step.counters.impacts = before.impacts;
  step.counters.sequential_impacts = before.sequential_impacts;
  undo_step();
  begin_step();
  step.state = initial;
}

/// Extrapolates a step without contacts at nodes. The energy of the result is not linear in the coordinates
/// and velocities; Work::contact gets the difference.
PLIANT_INLINE void ContactStepping::extrapolate_rigid(StepContext& step, const std::vector<Coarse>& from,
                                                      const Fractions& finest, const State& initial) {
  StepContext at_end(dynamics_, step.state, step.work, step.counters, initial.time() + finest.length,
                     finest.length);
  const std::vector<int> parts = parts_touched(dynamics_.model(), record_.contacts);
  const auto balance_of = [&](const State& at) {
    return dynamics_.energy(at_end.t, at.q, at.v, parts, scratch_) - at.work.sum();
  };
  const double of_finest = balance_of(step.state);
  double balance = of_finest;
  for (const Coarse& coarse : from) balance += coarse.share * (of_finest - balance_of(coarse.computed));
  extrapolate(at_end, from, finest.last_contacts, parts);
  step.state.work[static_cast<int>(Work::contact)] += balance_of(step.state) - balance;
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
  const Whole whole{state, length, resting_at_start_, record_.contacts.size(), has_event(step, before)};
  restart_step(step, initial, before);
  const Fractions halves = step_fractions(2, method, step, whole, initial, scale.tolerance());
  const double method_error = method.pop_error();
  if (!halves.finite || !(method_error <= 1))
    return {std::numeric_limits<double>::infinity(), order, halves.length};
  const bool agreed = agree(whole, halves, has_event(step, before), state);
  const double contact_error = difference(whole, halves, agreed, scale, initial.time(), state);
  const double error = std::max(contact_error, method_error);
  if (agreed && !whole.has_event) {
    if (scale.tolerance() < step_doubling::kThirdsTolerance)
      return step_by_thirds(method, step, scale, whole, initial, before, error);
    if (error <= 1) extrapolate_rigid(step, {{whole.state, 1, whole.state}}, halves, initial);
  }
  return {error, order, halves.length};
}

/// Repeats the step from `initial` as n equal parts; step.state is the state at their end.
PLIANT_INLINE ContactStepping::Fractions ContactStepping::step_fractions(int n, Integrator& method,
                                                                         StepContext& step,
                                                                         const Whole& whole,
                                                                         const State& initial,
                                                                         double tolerance) {
  State& state = step.state;
  const double start = initial.time();
  Fractions result;
  for (int i = 0; i < n; ++i) {
    const bool last = i == n - 1;
    const double end = !last                            ? whole.length * (i + 1) / n
                       : whole.has_event && result.even ? initial.h
                                                        : whole.length,
                 h = end - result.length;
    if (i > 0) {
      resting_at_start_.clear();
      has_unlocated_ = false;
      at_friction_event_ = false;
    }
    result.last_contacts = record_.contacts.size();
    set_step(state, start + result.length, h);
    StepContext part(dynamics_, state, step.work, step.counters);
    const double advanced = step_once(method, part, tolerance);
    result.length = advanced == h ? end : result.length + advanced;
    if (!last) {
      result.even = result.even && advanced == h;
      result.equal_contacts =
          result.equal_contacts && record_.contacts.size() - result.last_contacts == whole.contacts;
    }
    if (i == 0)
      result.gravity_velocities =
          whole.length * step_doubling::gravity_after_loss(dynamics_.model(), resting_, whole.resting,
                                                           record_.contacts, start);
    result.finite = state.q.allFinite() && state.v.allFinite();
    if (!result.finite) break;
  }
  state.start = initial.start;
  state.step = initial.step;
  state.h = initial.h;
  return result;
}

/// Returns whether the whole step and its parts have equal lengths, modes of joints, limits and sleep, and
/// numbers of contacts, and whether both or neither ended at an event. If both ended at an event, total
/// lengths and the contacts of all parts but the last are not compared; these parts must still have their
/// full length. has_event: whether the parts ended at an event.
PLIANT_INLINE bool ContactStepping::agree(const Whole& whole, const Fractions& fractions, bool has_event,
                                          const State& state) const {
  return fractions.even && has_event == whole.has_event &&
         (whole.has_event || fractions.length == whole.length) && state.at_limit == whole.state.at_limit &&
         state.joints == whole.state.joints && same_sleepers(state.at_rest, whole.state.at_rest) &&
         record_.contacts.size() - fractions.last_contacts == whole.contacts &&
         (whole.has_event || fractions.equal_contacts);
}

/// Returns the difference between the whole step and its repetition in parts, measured in tolerances.
PLIANT_INLINE double ContactStepping::difference(const Whole& whole, const Fractions& fractions, bool agreed,
                                                 const ErrorScale& scale, double start,
                                                 const State& state) const {
  const Model& model = dynamics_.model();
  VecX<double> rate;
  dynamics_.coordinate_rates(whole.state.q, whole.state.v, rate);
  const Difference to_whole{state.q - whole.state.q - (fractions.length - whole.length) * rate,
                            state.v - whole.state.v};
  const double max_speed =
      step_doubling::kJumpInGravity * whole.length * model.body().gravity_at(start).norm();
  const bool jumped = !agreed && step_doubling::has_jump(model, to_whole.v, max_speed);
  return measure(to_whole, whole.length, fractions, jumped, scale, state);
}

/// Returns the size of a difference of two results, in tolerances, or the error by contacts that the first
/// part of a repetition has lost, whichever is larger. length: length of the step, s. jumped: whether the
/// velocities differ by a jump.
PLIANT_INLINE double ContactStepping::measure(const Difference& difference, double length,
                                              const Fractions& fractions, bool jumped,
                                              const ErrorScale& scale, const State& state) const {
  // Returns the displacement by a difference of velocities in the step.
  auto displacement = [&](const VecX<double>& v) {
    VecX<double> rate;
    dynamics_.coordinate_rates(state.q, v, rate);
    return scale.norm(length * rate);
  };
  const double slow = slow_rate(dynamics_.model()) * length;  // without unit
  const bool brief = slow <= step_doubling::kBriefStep,
             by_displacement =
                 brief || (jumped && slow <= longest_contact_step(ContactSettings{}, scale.tolerance()));
  const VecX<double> none = VecX<double>::Zero(state.q.size());
  const double end_error = by_displacement ? std::max(scale.norm(difference.q), displacement(difference.v))
                                           : scale.norm(difference.q, difference.v, state.v),
               loss_error = brief ? displacement(fractions.gravity_velocities)
                                  : scale.norm(none, fractions.gravity_velocities, state.v);
  return std::max(end_error, loss_error);
}

/// Increases State::contact_residual to at least gap / h and the normal speed of each contact with a normal
/// impulse, from number `first` in the record on. Gaps are not linear in the coordinates, so that the
/// displacement by the impulses, and extrapolation, leave small gaps. Without this increase the next step
/// would treat these contacts as impacts. t: time of the state, s; h: length of the step, s.
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

/// Returns a copy of a state at the end of the finest steps, in which the coordinates and velocities of some
/// parts are finest + sum of share (finest - coarse).
PLIANT_INLINE State ContactStepping::extrapolated(const State& finest, const std::vector<Coarse>& from,
                                                  const std::vector<int>& parts) const {
  State state = finest;
  for (const int i : parts) {
    const PartModel& m = dynamics_.model().parts()[at(i)];
    for (const Coarse& coarse : from) {
      const auto move_on = [&](auto& x, const auto& fine, const auto& other, int first, int n) {
        x.segment(first, n) += coarse.share * (fine.segment(first, n) - other.segment(first, n));
      };
      move_on(state.q, finest.q, coarse.state.q, m.q0, m.n_q());
      move_on(state.v, finest.v, coarse.state.v, m.v0, m.n_v());
    }
  }
  normalise_rotations(dynamics_.model(), state.q);
  return state;
}

/// Changes c_dot of the parts that deform locally so that their linear momenta are `momenta`, in the form
/// that local_momenta() returns. Momenta are extrapolated like velocities, but are not linear in the
/// coordinates, and nodes that keep the positions of the halves change them. t: time of the state, s.
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

/// Replaces the state of some parts at the end of the finest steps by its Richardson extrapolation. last:
/// number of the first contact of the last of these steps in the record. Works are extrapolated, too.
/// Energies are not linear in the coordinates and velocities, so that the energy changes by more than the
/// works.
PLIANT_INLINE void ContactStepping::extrapolate(StepContext& step, const std::vector<Coarse>& from,
                                                std::size_t last, const std::vector<int>& parts) {
  const Model& model = dynamics_.model();
  State& state = step.state;
  auto momenta_of = [&](const State& at_end) {
    dynamics_.evaluate_masses(step.t, at_end.q, at_end.v, parts, scratch_);
    return step_doubling::local_momenta(model, parts, scratch_);
  };
  const std::vector<Vec3<double>> of_finest = momenta_of(state);
  std::vector<Vec3<double>> momenta = of_finest;
  Vec<double, kWorks> work = state.work;
  for (const Coarse& coarse : from) {
    const std::vector<Vec3<double>> of_coarse = momenta_of(coarse.computed);
    for (std::size_t i = 0; i < momenta.size(); ++i)
      momenta[i] += coarse.share * (of_finest[i] - of_coarse[i]);
    work += coarse.share * (state.work - coarse.computed.work);
  }
  state = extrapolated(state, from, parts);
  state.work = work;
  project_frames(step, parts);
  keep_momenta(step.t, momenta, parts, state);
  project_joints(step);
  project_limits(step);
  include_openings(last, step.t, step.h, state);
}

}  // namespace pliant
