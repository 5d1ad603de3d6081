// The steps of a simulation. The stages of a step, with the files that contain them:
//   1 begin      store the state, to restore it if the step fails       this file
//   2 switch     engage and release joints at their times               project/joint_switching-inl.h
//   3 integrate  advance q, v and work by the method of integration     method/*-inl.h
//                evaluate the accelerations, Eqs. (11)-(14)             body/dynamics-inl.h
//                project limits and joints                              project/project_joints-inl.h
//   4 contact    predict, advance, detect, locate, resolve, correct,    contact/contact_stepping-inl.h
//                sleep: around stage 3
//   5 accept     accept the step, or reject and repeat it shorter       simulate/controlled_step-inl.h
//   6 paths      apply impulses at kinks of prescribed paths            project/follow_paths-inl.h
//   7 check      reject states that are not valid                       simulate/failure_report-inl.h
#pragma once

#include <pliant/simulate/simulation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include <pliant/body/advance.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/math/finite.h>
#include <pliant/math/flush_subnormals.h>
#include <pliant/math/header_only.h>
#include <pliant/project/project.h>
#include <pliant/simulate/check_state.h>
#include <pliant/simulate/choose_integrator.h>
#include <pliant/simulate/clusters.h>
#include <pliant/simulate/failure_report.h>
#include <pliant/simulate/predicted_conflict.h>

namespace pliant {

namespace simulation {
/// Times are equal if they differ by at most kNear times the step, or by at most kUlps units in the last
/// place.
inline constexpr double kNear = 1e-9, kUlps = 8;
/// If joints contradict each other after a step, the step is tried again as this number of shorter steps, to
/// determine whether the length of the step is the cause.
inline constexpr int kShorterSteps = 16;

/// Throws std::invalid_argument if a tolerance is out of range.
inline void require_tolerance(double tolerance) {
  if (tolerance >= kMinTolerance && tolerance <= kMaxTolerance) return;
  std::ostringstream message;
  message << "a tolerance of " << tolerance << "; expected a number from " << kMinTolerance << " to "
          << kMaxTolerance;
  throw std::invalid_argument(message.str());
}

/// Calls act() and returns its result. Throws NumericalFailure with time t (s) in place of InvertedElement.
template <class F>
auto at_time(double t, F&& act) {
  try {
    return act();
  } catch (const InvertedElement& failure) {
    std::ostringstream message;
    message << "at t = " << t << " s: " << failure.what();
    throw NumericalFailure(message.str(), t);
  }
}

}  // namespace simulation

PLIANT_INLINE Simulation::Simulation(MultiBody& body, const std::string& integrator, int threads,
                                     double tolerance, const std::function<bool()>& stop)
    : model_(body),
      pool_(threads > 1 ? std::make_unique<ThreadPool>(threads) : nullptr),
      dynamics_(model_, pool_.get()),
      switching_(dynamics_),
      contact_(body.contact.active ? std::make_unique<ContactStepping>(dynamics_) : nullptr),
      state_(model_.initial_state()),
      without_inertia_(static_cast<std::size_t>(model_.n_v())) {
  const bool automatic = integrator == kAutomatic;
  const double requested = automatic && tolerance == 0 ? kStandardTolerance : tolerance;
  if (requested != 0) {
    simulation::require_tolerance(requested);
    scale_.emplace(model_, requested);
  }
  if (!automatic) set_method(make_integrator(integrator));
  const bool projected = body.stabilization.projection.value_or(true);
  const bool first_order = !automatic && integrator_->order() == 1;
  // In contact, the steps of a method with implicit local elasticity are of first order. With a tolerance the
  // joint policy ignores this reduction of the order, because the steps are short enough.
  const bool first_order_in_contact = !automatic && integrator_->local_is_implicit() && !scale_;
  dynamics_.set_joint_policy({first_order, projected, first_order || first_order_in_contact});
  simulation::at_time(0, [&] {
    if (body.stabilization.assemble_first) assembly_ = assemble(dynamics_, state_);
    StepContext start(dynamics_, state_, work_, step_counters_, 0, 0);
    project_frames(start);
    if (!model_.joints().empty()) dynamics_.accelerations(0, state_.q, state_.v, state_, work_);
    switching_.engage(start, std::vector<bool>(model_.islands().size(), true));
    if (automatic) {
      choice_ = choose_integrator(dynamics_, *scale_, state_, stop);
      set_method(make_integrator(choice_.integrator));
    }
    start_energy_ = dynamics_.ledger(state_, work_).energy() - state_.work.sum();
    first_ = state_;
  });
  forget_evaluations();
  if (!scale_ || !model_.forms_clusters()) return;
  clusters_ = std::make_unique<Clusters>(*this);
  state_.step_memory.resize(model_.parts().size());
}

PLIANT_INLINE Simulation::Simulation(const Simulation& whole, const std::vector<int>& parts)
    : model_(whole.model_.body(), parts),
      dynamics_(model_),
      switching_(dynamics_),
      contact_(std::make_unique<ContactStepping>(dynamics_, whole.contact_->finder())),
      state_(model_.initial_state()),
      without_inertia_(static_cast<std::size_t>(model_.n_v())) {
  if (whole.scale_) scale_.emplace(model_, whole.scale_->tolerance());
  dynamics_.set_joint_policy(whole.dynamics_.joint_policy());
  set_method(make_integrator(whole.integrator_->name()));
}

PLIANT_INLINE Simulation::~Simulation() = default;

/// Sets the method. Throws std::invalid_argument if a part has too many velocities for the method, or if a
/// tolerance is given and the method has no error estimate.
PLIANT_INLINE void Simulation::set_method(std::unique_ptr<Integrator> method) {
  integrator_ = std::move(method);
  for (const PartModel& m : model_.parts())
    if (m.q0 >= 0 && m.n_v() > integrator_->max_velocities())
      throw std::invalid_argument("integrator '" + std::string(integrator_->name()) +
                                  "' has a dense matrix: part '" + m.part->name() + "' has " +
                                  std::to_string(m.n_v()) + " velocities; expected at most " +
                                  std::to_string(integrator_->max_velocities()) +
                                  ". Use 'linearly_implicit' or 'auto', or a lower resolution of the part");
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
  if (h != state_.h) {  // restart the count of steps: time is start + step * h
    state_.start = state_.time();
    state_.step = 0;
    state_.h = h;
  }
  interval_ = h;
  const double start = time();
  const StepCounters before = step_counters_;
  begin_step();
  if (contact_) contact_->begin_step();
  with_rollback(h, [&] { advance(h); });
  ++state_.step;
  watch_progress(start, before);
  end_step();
}

/// Stage 1: stores the state at the start of the step.
PLIANT_INLINE void Simulation::begin_step() {
  if (controller_) controller_(state_.time(), state_, state_.inputs);
  last_good_ = state_;
  switching_.begin_step();
}

/// Returns the largest stable step at the first state, s; infinity if it cannot be computed.
PLIANT_INLINE double Simulation::stable_step_at_start() {
  struct Swapped {
    State &one, &other;
    Swapped(State& a, State& b) : one(a), other(b) { std::swap(one, other); }
    ~Swapped() { std::swap(one, other); }
  };
  const Swapped at_start(state_, first_);
  try {
    return largest_stable_step(*this);
  } catch (const std::exception&) {
    return std::numeric_limits<double>::infinity();
  }
}

/// Returns the failure of a step of h seconds. Its message has the time and the length of the step, and the
/// parts that have burst before the step. If the length of the step is fixed and above the largest stable
/// step at the first state, the message also has the largest stable step. t: time of the failure, s.
PLIANT_INLINE NumericalFailure Simulation::completed(const std::string& what, double t, double h) {
  std::ostringstream message;
  message << failure_report::place(state_.time(), h) << failure_report::burst_parts(model_, state_) << what;
  if (!scale_) {
    const double stable = stable_step_at_start();
    message.precision(3);
    if (stable < h) message << "; the largest stable step at the start is about " << stable << " s";
  }
  return {message.str(), t};
}

/// Calls step() for a step of h seconds. If step() throws, restores the state before the step, completes the
/// message of the failure and throws it again.
template <class Advance>
void Simulation::with_rollback(double h, Advance&& step) {
  try {
    step();
  } catch (const UnsatisfiableModel& failure) {
    const bool shorter = !scale_ && shorter_steps_pass(h);
    reject_step();
    const std::string place = failure_report::place(state_.time(), h);
    if (!shorter) throw UnsatisfiableModel(place + failure.what(), state_.time());
    std::ostringstream message;
    message << place << failure.what() << "; the step is too long: steps of " << h / simulation::kShorterSteps
            << " s pass this time";
    throw NumericalFailure(message.str(), state_.time());
  } catch (const InvertedElement& failure) {
    reject_step();
    throw completed(failure.what(), state_.time(), h);
  } catch (const NumericalFailure& failure) {
    reject_step();
    fail_on_predicted_conflict(dynamics_, state_, h);
    throw completed(failure.what(), failure.time, h);
  } catch (...) {
    reject_step();
    throw;
  }
}

/// Returns whether shorter steps succeed in place of a step of h seconds in which joints contradict each
/// other. Changes the state; the caller must restore it.
PLIANT_INLINE bool Simulation::shorter_steps_pass(double h) {
  state_ = last_good_;
  try {
    for (int i = 0; i < simulation::kShorterSteps; ++i) {
      state_.start = last_good_.time() + i * h / simulation::kShorterSteps;
      state_.step = 0;
      state_.h = h / simulation::kShorterSteps;
      advance(h / simulation::kShorterSteps);
    }
  } catch (const StepFailure&) {
    return false;
  } catch (const InvertedElement&) {
    return false;
  }
  return state_.q.allFinite() && state_.v.allFinite();
}

/// Stages 3 and 4: advances the state. Returns the length of the step, s. With a tolerance the step may end
/// early, at an impact or a change of friction.
PLIANT_INLINE double Simulation::integrate() {
  StepContext step = context();
  if (contact_) return contact_->step(*integrator_, step, scale_ ? scale_->tolerance() : 0);
  integrator_->step(step);
  return state_.h;
}

/// Stages 2 to 4 and 6 of a step of fixed length: advances the state by h seconds. The step is divided at the
/// times of Model::switch_times() and at the kinks of Model::next_kink(). The caller increments State::step.
PLIANT_INLINE void Simulation::advance(double h) {
  const std::vector<double>& times = model_.switch_times();
  if (times.empty() && !model_.may_have_kinks()) {
    integrate();
    return;
  }
  const double end = state_.time() + h;
  const double tolerance = std::max(
      simulation::kNear * h, simulation::kUlps * std::numeric_limits<double>::epsilon() * std::abs(end));
  const double start = state_.start;
  const std::int64_t step = state_.step;
  double now = state_.time(), from = switching_.after_kink(now, tolerance);
  switch_joints(from, tolerance);
  while (now < end - tolerance) {
    const auto next = std::upper_bound(times.begin(), times.end(), now + tolerance);
    const double stop = next == times.end() || *next > end - tolerance ? end : *next;
    const Kink kink = model_.next_kink(now + tolerance, stop + tolerance);
    const bool has_kink = std::isfinite(kink.time);
    const double to = has_kink ? just_before(kink.time) : stop;
    if (from != state_.time() || to != end) {
      state_.start = from;
      state_.step = 0;
      state_.h = to - from;
    }
    integrate();
    now = has_kink && kink.time < stop - tolerance ? kink.time : stop;
    from = has_kink ? just_after(kink.time) : now;
    switch_joints(from, tolerance);
    if (has_kink) follow_paths(kink.time, tolerance);
  }
  state_.start = start;
  state_.step = step;
  state_.h = h;
}

PLIANT_INLINE StepContext Simulation::context() {
  return {dynamics_, state_, work_, step_counters_};
}

/// Stage 2: engages and releases joints at time t, s. Times that differ by at most the tolerance (s) are
/// equal.
PLIANT_INLINE void Simulation::switch_joints(double t, double tolerance) {
  if (model_.switch_times().empty()) return;
  StepContext at(dynamics_, state_, work_, step_counters_, t, state_.h);
  switching_.switch_at(at, tolerance);
}

/// Stage 6: at a kink (Model::next_kink(), s), applies the impulses of prescribed paths whose velocity jumps,
/// and switches springs. Times that differ by at most the tolerance (s) are equal.
PLIANT_INLINE void Simulation::follow_paths(double kink, double tolerance) {
  switch_springs(kink, tolerance);
  StepContext after(dynamics_, state_, work_, step_counters_, just_after(kink), state_.h);
  switching_.follow_paths(after, kink, tolerance);
}

/// Adds the energy of each spring that begins to act at a kink (s) to the work of anchors, subtracts the
/// energy of each spring that ceases to act, and wakes their parts.
PLIANT_INLINE void Simulation::switch_springs(double kink, double tolerance) {
  for (const SpringModel& spring : model_.springs()) {
    const bool begins = std::abs(spring.spring->on - kink) <= tolerance,
               ceases = std::abs(spring.spring->off - kink) <= tolerance;
    if (begins == ceases) continue;
    State at_kink = state_;
    at_kink.start = kink;
    at_kink.step = 0;
    const double energy = model_.energy(spring, at_kink);
    state_.work[static_cast<int>(Work::anchors)] += begins ? energy : -energy;
    for (const PortRef& end : {spring.a, spring.b})
      if (end.part >= 0) wake(state_, end.part);
  }
}

/// Stage 7: counts the step, and rejects a state that is not valid.
PLIANT_INLINE void Simulation::end_step() {
  ++step_counters_.steps;
  const std::string fault = failure_report::fault_of(model_, state_, work_);
  if (!fault.empty()) fail_by(fault);
  if (contact_) record_contact_errors();
  record_without_inertia();
}

/// Adds the errors of contact of the step to the counters.
PLIANT_INLINE void Simulation::record_contact_errors() {
  const ContactRecord& record = contact_->record();
  step_counters_.contact_overlap = std::max(step_counters_.contact_overlap, record.overlap);
  step_counters_.worst_residual.keep_worse(record.worst_residual);
  step_counters_.worst_overlap.keep_worse(record.worst_overlap);
}

/// Restores the state before the step and throws NumericalFailure, or UnsatisfiableModel if a conflict of
/// joints is predicted. fault: the result of failure_report::fault_of() for the state after the step.
PLIANT_INLINE void Simulation::fail_by(const std::string& fault) {
  const std::string cause = failure_report::cause(dynamics_, last_good_);
  reject_step();
  fail_on_predicted_conflict(dynamics_, state_, state_.h);
  throw completed(fault + " after the step; " + cause, state_.time(), state_.h);
}

/// Records the velocities without inertia in the last evaluation of the step.
PLIANT_INLINE void Simulation::record_without_inertia() {
  for (std::size_t i = 0; i < work_.without_inertia.size(); ++i) {
    if (work_.without_inertia[i] == 0) continue;
    const PartModel& m = model_.parts()[i];
    for (int k = 0; k < 6 + m.n_s; ++k)
      if (work_.parts[i].without_inertia(k)) without_inertia_[static_cast<std::size_t>(m.v0 + k)] = true;
  }
}

PLIANT_INLINE std::set<std::string> Simulation::velocities_without_inertia() const {
  std::set<std::string> names;
  for (const PartModel& m : model_.parts())
    for (int k = 0; m.q0 >= 0 && k < 6 + m.n_s; ++k)
      if (without_inertia_[static_cast<std::size_t>(m.v0 + k)]) {
        std::string name = model_.velocity_name(m.v0 + k);
        if (k >= 6) name.resize(name.size() - 4);  // without _dot
        names.insert(name);
      }
  return names;
}

PLIANT_INLINE void Simulation::set_state(State state) {
  simulation::check_sizes(state, model_);
  if (!contact_) state.contact_cache.clear();
  simulation::check_contact_cache(state, model_);
  if (state.contact_cache.empty()) state.contact_cache_age = 0;
  simulation::check_step_memory(state);
  if (!clusters_) state.step_memory.clear();
  if (clusters_ && state.step_memory.empty())
    state.step_memory.assign(model_.parts().size(), {0, 0, state.contact_residual, state.contact_cache_age});
  state_ = std::move(state);
  first_ = state_;
  switching_.forget_after(time() + simulation::kNear * state_.h);
  if (contact_) contact_->begin_step();  // no contacts yet
}

PLIANT_INLINE VecX<double> Simulation::sensors() {
  if (model_.sensors().empty()) return VecX<double>(0);
  VecX<double> values;
  evaluate_output([&](Workspace<double>& work) {
    dynamics_.accelerations(state_.time(), state_.q, state_.v, state_, work);
    values = dynamics_.sensor_values(state_.time(), state_, work);
  });
  return values;
}

PLIANT_INLINE Ledger Simulation::ledger() {
  Ledger ledger;
  evaluate_output([&](Workspace<double>& work) {
    ledger = simulation::at_time(time(), [&] { return dynamics_.ledger(state_, work); });
  });
  ledger.balance = ledger.energy() - start_energy_ - ledger.work.sum();
  return ledger;
}

PLIANT_INLINE Counters Simulation::counters() const {
  Counters sum = absorbed_counters_;
  for (const PartWorkspace<double>& w : work_.parts) sum += w.counters;
  for (const RigidWorkspace& w : work_.rigid) sum += w.counters;
  return sum - output_counters_;
}

}  // namespace pliant
