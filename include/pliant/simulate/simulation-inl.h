// A step of a simulation. Its stages, with the files that contain them:
//   1 begin      keep the state to return to if the step fails          this file
//   2 switch     engage and release joints at their times               project/joint_switching-inl.h
//   3 integrate  advance q, v and work by the method of integration     method/*-inl.h
//                evaluate the accelerations, Eqs. (11)-(14)             body/dynamics-inl.h
//                project limits and joints                              project/project_joints-inl.h
//   4 contact    predict, advance, detect, locate, resolve, correct,    contact/contact_stepping.h
//                sleep: around stage 3
//   5 accept     accept the step, or repeat it shorter, by its error    simulate/step_length.h
//   6 paths      apply impulses at kinks of prescribed paths            project/follow_paths-inl.h
//   7 check      refuse states that are not finite                      simulate/failure_report.h
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include <pliant/body/advance.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/contact/longest_contact_step.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/math/finite.h>
#include <pliant/math/flush_subnormals.h>
#include <pliant/math/header_only.h>
#include <pliant/project/project.h>
#include <pliant/simulate/choose_integrator.h>
#include <pliant/simulate/failure_report.h>
#include <pliant/simulate/predicted_conflict.h>
#include <pliant/simulate/simulation.h>
#include <pliant/simulate/step_length.h>

#include <pliant/contact/contact_pairs.h>

namespace pliant {

namespace simulation {
/// Times are equal within this share of a step, or this many units in the last place.
inline constexpr double kNear = 1e-9, kUlps = 8;
/// A step after which joints do not close is repeated in this many shorter steps.
inline constexpr int kShorter = 16;
/// Shortest step to a tolerance, relative to the time.
inline constexpr double kLeastStep = 16 * std::numeric_limits<double>::epsilon();

inline void require_tolerance(double tolerance) {
  if (tolerance >= kLeastTolerance && tolerance <= kGreatestTolerance) return;
  std::ostringstream message;
  message << "a tolerance of " << tolerance << "; expected a number from " << kLeastTolerance << " to "
          << kGreatestTolerance;
  throw std::invalid_argument(message.str());
}

/// Calls act(); an inverted element in it is a failure of the run at time t, s.
template <class F>
auto at_time(double t, F&& act) {
  try {
    return act();
  } catch (const InvertedElement& failure) {
    throw NumericalFailure(failure.what(), t);
  }
}

/// Throws std::invalid_argument if the contact cache of a state is not finite, not of this model or not
/// sorted.
inline void check_contact_cache(const State& state, const Model& model) {
  const std::vector<CachedContact>& contact_cache = state.contact_cache;
  if (state.contact_cache_age < 0)
    throw std::invalid_argument("the contact cache of this state has a negative age");
  const ContactSettings& contact = model.body().contact;
  const std::array<std::size_t, 4> counts{model.parts().size(), model.parts().size(), contact.planes.size(),
                                          contact.obstacles.size()};
  for (const CachedContact& support : contact_cache) {
    bool fits = support.between[0] >= 0;
    for (std::size_t i = 0; i < counts.size(); ++i)
      fits = fits && support.between[i] >= -1 && support.between[i] < static_cast<int>(counts[i]);
    if (!fits) throw std::invalid_argument("a cached contact of this state belongs to another model");
    if (!support.x.allFinite() || !support.force.allFinite())
      throw std::invalid_argument("a cached contact of this state is not finite");
  }
  if (!std::is_sorted(contact_cache.begin(), contact_cache.end(), ByPair{}))
    throw std::invalid_argument("the contact cache of this state is not sorted by the pairs of bodies");
}

}  // namespace simulation

PLIANT_INLINE Simulation::Simulation(MultiBody& body, const std::string& integrator, int threads,
                                     double tolerance)
    : model_(body),
      pool_(threads > 1 ? std::make_unique<ThreadPool>(threads) : nullptr),
      dynamics_(model_, pool_.get()),
      switching_(dynamics_),
      contact_(body.contact.active ? std::make_unique<ContactStepping>(dynamics_) : nullptr),
      state_(model_.initial_state()),
      held_(static_cast<std::size_t>(model_.n_v())) {
  const bool automatic = integrator == kAutomatic;
  const double asked = automatic && tolerance == 0 ? kStandardTolerance : tolerance;
  if (asked != 0) {
    simulation::require_tolerance(asked);
    scale_.emplace(model_, asked);
  }
  if (!automatic) set_method(make_integrator(integrator));
  const bool projected = body.stabilization.projection.value_or(true);
  const bool first = !automatic && integrator_->order() == 1;
  // Its steps in contact are of first order; with a tolerance they are short enough.
  const bool at_times = !automatic && integrator_->local_is_implicit() && !scale_;
  dynamics_.set_joint_policy({first, projected, first || at_times});
  simulation::at_time(0, [&] {
    if (body.stabilization.assemble_first) assembly_ = assemble(dynamics_, state_);
    StepContext start(dynamics_, state_, output_work_, step_counters_, 0, 0);
    project_frames(start);
    if (!model_.joints().empty()) dynamics_.accelerations(0, state_.q, state_.v, state_, output_work_);
    switching_.engage(start, std::vector<bool>(model_.islands().size(), true));
    if (automatic) {
      choice_ = choose_integrator(dynamics_, *scale_, state_);
      set_method(make_integrator(choice_.integrator));
    }
    start_energy_ = dynamics_.ledger(state_, output_work_).energy() - state_.work.sum();
  });
  for (PartWorkspace<double>& w : output_work_.parts) w.counters = {};
}

PLIANT_INLINE Simulation::~Simulation() = default;

/// Sets the method. Throws std::invalid_argument if there is a tolerance and the method has no error
/// estimate.
PLIANT_INLINE void Simulation::set_method(std::unique_ptr<Integrator> method) {
  integrator_ = std::move(method);
  if (!scale_) return;
  integrator_->measure(&*scale_);
  if (integrator_->error_order() > 0) return;
  std::ostringstream message;
  message << "integrator '" << integrator_->name()
          << "' has no error estimate, which a tolerance needs; expected one of '" << kAutomatic << "'";
  for (const std::string& name : controlled_integrators()) message << ", '" << name << "'";
  throw std::invalid_argument(message.str());
}

PLIANT_INLINE void Simulation::step(double h) {
  const FlushSubnormals flushed;
  if (!(h > 0) || !std::isfinite(h)) {
    std::ostringstream message;
    message << "a step of " << h << " s; expected a positive, finite time";
    throw std::invalid_argument(message.str());
  }
  if (scale_) {
    for (const double end = time() + h; time() < end;) step_up_to(end);
    return;
  }
  if (h != state_.h) {  // a new step length starts a new count: time is count * step
    state_.start = state_.time();
    state_.step = 0;
    state_.h = h;
  }
  begin_step();
  if (contact_) contact_->begin_step();
  guarded(h, [&] { advance(h); });
  ++state_.step;
  end_step();
}

/// Stage 1: keeps the state at the start of the step.
PLIANT_INLINE void Simulation::begin_step() {
  last_good_ = state_;
  switching_.begin_step();
}

/// Calls `step` for a step of h seconds. If it throws, restores the last good state and completes the
/// message.
template <class Advance>
void Simulation::guarded(double h, Advance&& step) {
  try {
    step();
  } catch (const UnsatisfiableModel& failure) {
    const bool shorter = !scale_ && shorter_steps_pass(h);
    reject_step();
    if (!shorter) throw UnsatisfiableModel(failure.what(), state_.time());
    std::ostringstream message;
    message << "a step of " << h << " s is too long for the motion: " << failure.what()
            << ", but not after steps of " << h / simulation::kShorter << " s";
    throw NumericalFailure(message.str(), state_.time());
  } catch (const InvertedElement& failure) {
    reject_step();
    throw NumericalFailure(failure_report::burst_parts(model_, state_) + failure.what(), state_.time());
  } catch (const NumericalFailure& failure) {
    reject_step();
    fail_on_predicted_conflict(dynamics_, state_, h);
    throw NumericalFailure(failure_report::burst_parts(model_, state_) + failure.what(), failure.time);
  } catch (...) {
    reject_step();
    throw;
  }
}

PLIANT_INLINE void Simulation::step_up_to(double until) {
  const FlushSubnormals flushed;
  if (!scale_) throw std::logic_error("a simulation without a tolerance has no step of its own");
  const double now = time();
  if (!(until > now) || !std::isfinite(until)) {
    std::ostringstream message;
    message << "a step from " << now << " s cannot end at " << until << " s";
    throw std::invalid_argument(message.str());
  }
  const double least = simulation::kLeastStep * std::max(std::abs(now), std::abs(until));
  const std::vector<double>& times = model_.switch_times();
  const auto next = std::upper_bound(times.begin(), times.end(), now + least);
  const double end = next == times.end() ? until : std::min(until, *next);
  state_.start = now;
  state_.step = 0;
  begin_step();
  switch_joints(now, least);
  state_.start = switching_.after_kink(now, least);
  const int order = integrator_->error_order();
  if (!(state_.h > 0)) {
    StepContext begin = context();
    state_.h = first_step(begin, *scale_, order);
  }
  // A step that ends near `end` is extended to it, by at most this factor.
  constexpr double further = 1.1;
  const Kink kink = model_.next_kink(now + least, std::min(end, now + further * state_.h) + least);
  const bool bends = std::isfinite(kink.time);
  const double stop = bends ? just_before(kink.time) : end;
  const bool done = take_controlled_step(state_, stop, least, growth_of(*integrator_, model_), step_counters_,
                                         [&] { return try_step(); });
  if (!done) guarded(state_.h, [&] { fail_to_meet_tolerance(); });
  const bool at_kink = bends && state_.start >= stop;
  if (at_kink) state_.start = std::min(kink.time, end);
  switch_joints(at_kink ? just_after(kink.time) : state_.start, least);
  if (at_kink) guarded(state_.h, [&] { follow_paths(kink.time, least); });
  end_step();
}

PLIANT_INLINE void Simulation::reject_step() {
  state_ = last_good_;
  switching_.undo_step();
  if (contact_) contact_->undo_step();
}

/// Takes a step of the length in the state; returns its error: that of the method, with located impacts. If
/// few bodies rest on each other, or more meet than are located, step doubling estimates the error of
/// contact. If many bodies do, or soft ones, the error is not estimated and the step is limited instead.
PLIANT_INLINE StepError Simulation::try_step() {
  if (contact_) {
    contact_->begin_step();
    begun_ = state_;
  }
  const int order = integrator_->error_order();
  StepError result{std::numeric_limits<double>::infinity(), order, state_.h};
  const long impacts = step_counters_.impacts;
  try {
    result.length = take_step();
    const double error = integrator_->take_error();
    if (state_.q.allFinite() && state_.v.allFinite()) result.error = error;
    if (contact_ && result.error <= 1 && contact_->has_contact_error()) step_in_contact(impacts, result);
  } catch (const StepFailure&) {
    integrator_->take_error();
    result.error = std::numeric_limits<double>::infinity();
  } catch (const InvertedElement&) {
    integrator_->take_error();
    result.error = std::numeric_limits<double>::infinity();
  }
  if (contact_ && !(result.error <= 1)) {
    contact_->undo_step();
    step_counters_.impacts = impacts;
  }
  return result;
}

/// Completes the error of a step in which bodies rested on each other. impacts: their number before the step.
PLIANT_INLINE void Simulation::step_in_contact(long impacts, StepError& result) {
  const bool few = contact_->may_double();
  // The work of forces on resting bodies is booked for a motion that does not happen: steps stay short for
  // that.
  if (!few || !model_.body().forces().empty()) {
    const double share = result.length / longest_contact_step(model_.body().contact, scale_->tolerance());
    if (!few || share > 1) {
      result.order = 0;
      result.error = std::max(result.error, share);
      if (result.error <= 1) ++step_counters_.uncontrolled;
      return;
    }
  }
  StepContext step = context();
  const StepError halves =
      contact_->step_by_doubling(*integrator_, step, *scale_, begun_, result.length, impacts);
  if (!(halves.error <= result.error)) result = halves;
  result.length = halves.length;
}

/// Throws the failure of a step that cannot be shorter.
PLIANT_INLINE void Simulation::fail_to_meet_tolerance() {
  take_step();
  std::ostringstream message;
  message << "the error of a step from t = " << last_good_.time() << " s stays above the tolerance of "
          << scale_->tolerance()
          << " however short it is; expected a larger tolerance, or motion without jumps";
  throw NumericalFailure(message.str(), last_good_.time());
}

/// Returns whether joints that do not close after a step close after shorter steps.
PLIANT_INLINE bool Simulation::shorter_steps_pass(double h) {
  state_ = last_good_;
  try {
    for (int i = 0; i < simulation::kShorter; ++i) {
      state_.start = last_good_.time() + i * h / simulation::kShorter;
      state_.step = 0;
      state_.h = h / simulation::kShorter;
      advance(h / simulation::kShorter);
    }
  } catch (const StepFailure&) {
    return false;
  } catch (const InvertedElement&) {
    return false;
  }
  return state_.q.allFinite() && state_.v.allFinite();
}

/// Stages 3 and 4: returns the length of the step, s; with a tolerance it may end early, at an impact.
PLIANT_INLINE double Simulation::take_step() {
  StepContext step = context();
  if (contact_) return contact_->step(*integrator_, step, scale_.has_value());
  integrator_->step(step);
  return state_.h;
}

/// Advances the state by h, except the count of its steps, with stops where joints switch and paths have
/// kinks.
PLIANT_INLINE void Simulation::advance(double h) {
  const std::vector<double>& times = model_.switch_times();
  if (times.empty() && model_.driven_joints().empty()) {
    take_step();
    return;
  }
  const double end = state_.time() + h;
  const double near = std::max(simulation::kNear * h,
                               simulation::kUlps * std::numeric_limits<double>::epsilon() * std::abs(end));
  const double start = state_.start;
  const std::int64_t step = state_.step;
  double now = state_.time(), from = switching_.after_kink(now, near);
  switch_joints(from, near);
  while (now < end - near) {
    const auto next = std::upper_bound(times.begin(), times.end(), now + near);
    const double stop = next == times.end() || *next > end - near ? end : *next;
    const Kink kink = model_.next_kink(now + near, stop + near);
    const bool bends = std::isfinite(kink.time);
    const double to = bends ? just_before(kink.time) : stop;
    if (from != state_.time() || to != end) {
      state_.start = from;
      state_.step = 0;
      state_.h = to - from;
    }
    take_step();
    now = bends && kink.time < stop - near ? kink.time : stop;
    from = bends ? just_after(kink.time) : now;
    switch_joints(from, near);
    if (bends) follow_paths(kink.time, near);
  }
  state_.start = start;
  state_.step = step;
  state_.h = h;
}

PLIANT_INLINE StepContext Simulation::context() {
  return {dynamics_, state_, work_, step_counters_};
}

/// Stage 2: engages and releases joints at a time, s; times nearer than `near` are equal.
PLIANT_INLINE void Simulation::switch_joints(double t, double near) {
  if (model_.switch_times().empty()) return;
  StepContext at(dynamics_, state_, work_, step_counters_, t, state_.h);
  switching_.switch_at(at, near);
}

/// Stage 6: applies the impulses at a kink (s) of the prescribed paths.
PLIANT_INLINE void Simulation::follow_paths(double kink, double near) {
  StepContext after(dynamics_, state_, work_, step_counters_, just_after(kink), state_.h);
  switching_.follow_paths(after, kink, near);
}

/// Stage 7: counts the step, and refuses a state that is not finite.
PLIANT_INLINE void Simulation::end_step() {
  ++step_counters_.steps;
  const std::string where = failure_report::not_finite(model_, state_, work_);
  if (!where.empty()) fail_not_finite(where);
  record_held();
}

PLIANT_INLINE void Simulation::fail_not_finite(const std::string& where) {
  const State before = last_good_;
  std::ostringstream message;
  message << failure_report::burst_parts(model_, before) << "not a finite number in " << where
          << " after the step from t = " << before.time() << " s; "
          << failure_report::cause(dynamics_, before);
  reject_step();
  const double stable = largest_stable_step(*this);
  fail_on_predicted_conflict(dynamics_, before, before.h);
  message.precision(3);
  if (std::isfinite(stable)) message << "; the largest stable step here is about " << stable << " s";
  throw NumericalFailure(message.str(), before.time());
}

PLIANT_INLINE void Simulation::record_held() {
  for (std::size_t i = 0; i < work_.held.size(); ++i) {
    if (work_.held[i] == 0) continue;
    const PartModel& m = model_.parts()[i];
    for (int k = 0; k < 6 + m.n_s; ++k)
      if (work_.parts[i].held(k)) held_[static_cast<std::size_t>(m.v0 + k)] = true;
  }
}

PLIANT_INLINE std::set<std::string> Simulation::held() const {
  std::set<std::string> names;
  for (const PartModel& m : model_.parts())
    for (int k = 0; m.q0 >= 0 && k < 6 + m.n_s; ++k)
      if (held_[static_cast<std::size_t>(m.v0 + k)]) {
        std::string name = model_.velocity_name(m.v0 + k);
        if (k >= 6) name.resize(name.size() - 4);  // without _dot
        names.insert(name);
      }
  return names;
}

PLIANT_INLINE void Simulation::set_state(State state) {
  if (state.q.size() != model_.n_q() || state.v.size() != model_.n_v() ||
      static_cast<int>(state.at_limit.size()) != model_.n_limits() ||
      state.joints.size() != model_.joints().size() || state.at_rest.size() != model_.n_resting())
    throw std::invalid_argument("this state belongs to another model");
  if (!contact_) state.contact_cache.clear();
  simulation::check_contact_cache(state, model_);
  if (state.contact_cache.empty()) state.contact_cache_age = 0;
  state_ = std::move(state);
  switching_.forget_after(time() + simulation::kNear * state_.h);
  if (contact_) contact_->begin_step();  // no contacts yet
}

PLIANT_INLINE Ledger Simulation::ledger() {
  Ledger ledger = simulation::at_time(time(), [&] { return dynamics_.ledger(state_, output_work_); });
  ledger.balance = ledger.energy() - start_energy_ - ledger.work.sum();
  return ledger;
}

PLIANT_INLINE Counters Simulation::counters() const {
  Counters sum;
  for (const PartWorkspace<double>& w : work_.parts) sum += w.counters;
  for (const RigidWorkspace& w : work_.rigid) sum += w.counters;
  return sum;
}

}  // namespace pliant
