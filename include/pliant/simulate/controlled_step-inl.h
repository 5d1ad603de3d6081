// Function bodies of simulation.h: steps to a tolerance. The length of a step follows from the error
// (step_length.h); a step whose error is too large is rejected and repeated with a shorter length.
#pragma once

#include <pliant/simulate/simulation-inl.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <vector>

#include <pliant/contact/contact_stepping.h>
#include <pliant/contact/longest_contact_step.h>
#include <pliant/math/flush_subnormals.h>
#include <pliant/math/header_only.h>
#include <pliant/simulate/clusters.h>
#include <pliant/simulate/step_length.h>

namespace pliant {

namespace controlled_step {

/// Shortest step with a tolerance, as a share of the time.
inline constexpr double kMinStep = 16 * std::numeric_limits<double>::epsilon();

}  // namespace controlled_step

PLIANT_INLINE void Simulation::step_up_to(double until) {
  const FlushSubnormals flushed;
  if (!scale_)
    throw std::logic_error("step_up_to() needs a tolerance, which determines the length of the step");
  const double now = time();
  if (!(until > now) || !std::isfinite(until)) {
    std::ostringstream message;
    message << "a step from " << now << " s cannot end at " << until << " s; expected a later, finite time";
    throw std::invalid_argument(message.str());
  }
  interval_ = until - first_.time();
  const double min_step = controlled_step::kMinStep * std::max(std::abs(now), std::abs(until));
  const std::vector<double>& times = model_.switch_times();
  const auto next = std::upper_bound(times.begin(), times.end(), now + min_step);
  const double end = next == times.end() ? until : std::min(until, *next);
  state_.start = now;
  state_.step = 0;
  begin_step();
  switch_joints(now, min_step);
  state_.start = switching_.after_kink(now, min_step);
  // A step that ends shortly before `end` is extended to `end`, at most by this factor.
  constexpr double max_extension = 1.1;
  const double longest = clusters_      ? clusters_->end_of_interval(state_.start) - now
                         : state_.h > 0 ? max_extension * state_.h
                                        : end - now,
               last = std::min(end, now + longest);
  const Kink kink = model_.next_kink(now + min_step, last + min_step);
  const bool has_kink = std::isfinite(kink.time);
  const double stop = has_kink ? just_before(kink.time) : clusters_ ? last : end;
  if (clusters_)
    advance_clusters(stop);
  else
    controlled_step(stop);
  const bool at_kink = has_kink && state_.start >= stop;
  if (at_kink) state_.start = std::min(kink.time, end);
  switch_joints(at_kink ? just_after(kink.time) : state_.start, min_step);
  if (at_kink) with_rollback(state_.h, [&] { follow_paths(kink.time, min_step); });
  end_step();
}

/// Stages 3 to 5 with a tolerance: advances by one step of the length that the tolerance allows. The step
/// ends at the time `end` (s) at the latest.
PLIANT_INLINE void Simulation::controlled_step(double end) {
  if (!(state_.h > 0)) {
    StepContext begin = context();
    state_.h = first_step(begin, *scale_, integrator_->error_order());
  }
  const double min_step = controlled_step::kMinStep * std::max(std::abs(time()), std::abs(end));
  const double start = time();
  const StepCounters before = step_counters_;
  const bool done = take_controlled_step(state_, end, min_step, growth_of(*integrator_, model_),
                                         step_counters_, [&] { return try_step(); });
  if (!done) with_rollback(state_.h, [&] { fail_to_meet_tolerance(); });
  watch_progress(start, before);
}

/// Includes an accepted step in the watch of the progress (ProgressWatch). start: time at the start of the
/// step, s. before: the counters at this time. Throws NumericalFailure if the mean length of the steps of a
/// window is at most the shortest possible length.
PLIANT_INLINE void Simulation::watch_progress(double start, const StepCounters& before) {
  StepCounters work;
  work.rejected = step_counters_.rejected - before.rejected;
  work.impacts = step_counters_.impacts - before.impacts;
  work.evaluations = step_counters_.evaluations - before.evaluations;
  std::optional<SlowProgress> slow = watch_.add(start, time(), interval_, work);
  if (!slow) return;
  const VecX<double> none = VecX<double>::Zero(state_.q.size());
  const ErrorScale scale = scale_ ? *scale_ : ErrorScale(model_, kStandardTolerance);
  slow->fastest = scale.worst(none, state_.v - last_good_.v, state_.v);
  if (!slow_progress_) slow_progress_ = slow;
  if (slow->steps < ProgressWatch::kWindow ||
      slow->advance > static_cast<double>(slow->steps) * controlled_step::kMinStep * std::abs(time()))
    return;
  std::ostringstream message;
  message << slow->steps << " steps have advanced by " << slow->advance << " s only, with " << slow->impacts
          << " impacts; " << slow->fastest
          << " changes most: expected a motion without impacts that follow each other ever faster, or steps "
             "of fixed length";
  with_rollback(state_.h, [&] { throw NumericalFailure(message.str(), last_good_.time()); });
}

/// Stages 3 to 5 with a tolerance: advances all clusters to the time `end`, s.
PLIANT_INLINE void Simulation::advance_clusters(double end) {
  contact_->begin_step();
  try {
    clusters_->advance(end);
  } catch (...) {
    reject_step();
    throw;
  }
}

PLIANT_INLINE void Simulation::reject_step() {
  state_ = last_good_;
  switching_.undo_step();
  if (contact_) contact_->undo_step();
}

/// Attempts a step of the length in the state and returns its error; the error is infinite if the step fails.
/// The error estimate of the method includes the error of located impacts. If parts rest on each other, or if
/// impacts were not located, estimate_contact_error() adds the error of contact.
PLIANT_INLINE StepError Simulation::try_step() {
  if (contact_) {
    contact_->begin_step();
    attempt_start_ = state_;
  }
  const int order = integrator_->error_order();
  StepError result{std::numeric_limits<double>::infinity(), order, state_.h};
  const StepCounters before = step_counters_;
  try {
    result.length = integrate();
    const double error = integrator_->pop_error();
    if (state_.q.allFinite() && state_.v.allFinite()) result.error = error;
    if (contact_ && result.error <= 1 && contact_->has_contact_error())
      estimate_contact_error(before, result);
  } catch (const StepFailure&) {
    integrator_->pop_error();
    result.error = std::numeric_limits<double>::infinity();
  } catch (const InvertedElement&) {
    integrator_->pop_error();
    result.error = std::numeric_limits<double>::infinity();
  }
  if (contact_ && !(result.error <= 1)) {
    contact_->undo_step();
    step_counters_.impacts = before.impacts;
    step_counters_.sequential_impacts = before.sequential_impacts;
  }
  return result;
}

/// Includes the error of contact in the result of a step with resting contacts, or with impacts that were not
/// located. Step doubling estimates this error. With many moving parts or contacts at nodes, the error is
/// instead the ratio of the step to longest_contact_step(). before: the counters before the step.
PLIANT_INLINE void Simulation::estimate_contact_error(const StepCounters& before, StepError& result) {
  const bool may_double = contact_->may_double();
  // The work of forces and drives on resting bodies is computed for a motion that the contacts prevent.
  // Short steps limit the error of this work. Drives that exert no force in the step need no such limit.
  const bool has_forces = !model_.forces().empty() || !model_.distributed_forces().empty();
  const auto exerts_force = [&](const DriveModel& m) {
    for (const double share : {0.0, 0.25, 0.5, 0.75, 1.0})
      if (m.drive->may_exert_force(attempt_start_.time() + share * result.length)) return true;
    return false;
  };
  const bool has_drives = std::any_of(model_.drives().begin(), model_.drives().end(), exerts_force);
  if (!may_double || has_forces || has_drives) {
    const double share = result.length / longest_contact_step(model_.body().contact, scale_->tolerance());
    if (!may_double || share > 1) {
      result.order = 0;
      result.error = std::max(result.error, share);
      if (result.error <= 1) ++step_counters_.uncontrolled;
      return;
    }
  }
  StepContext step = context();
  const StepError halves =
      contact_->step_by_doubling(*integrator_, step, *scale_, attempt_start_, result.length, before);
  if (!(halves.error <= result.error)) result = halves;
  result.length = halves.length;
}

/// Throws the failure of a step that cannot be shorter: the failure of the method if the method fails again,
/// otherwise a NumericalFailure, because the error exceeds the tolerance.
PLIANT_INLINE void Simulation::fail_to_meet_tolerance() {
  const std::string term =
      dynamics_.diagnose(last_good_.time(), last_good_.q, last_good_.v, last_good_, work_);
  if (!term.empty()) throw NumericalFailure(term + " is not a finite number", last_good_.time());
  integrate();
  const VecX<double> none = VecX<double>::Zero(state_.q.size());
  std::ostringstream message;
  message << "the error of the shortest possible step exceeds the tolerance of " << scale_->tolerance()
          << "; " << scale_->worst(none, state_.v - last_good_.v, state_.v)
          << " changes most in it: expected a larger tolerance, or motion without jumps";
  throw NumericalFailure(message.str(), last_good_.time());
}

}  // namespace pliant
