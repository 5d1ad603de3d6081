// Function bodies of friction_events.h. first() lists the steps of the search; locate_end() finds the time at
// which a function of time ceases to be positive.
#pragma once

#include <pliant/contact/friction_events.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <pliant/body/speed_scale.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/impact_timing.h>
#include <pliant/contact/touched_parts.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace friction_events {

/// Slides shorter than kSlowInTolerances times the tolerance, in sizes of the smaller part, are ignored. A
/// contact sticks if its speed is at most the sum of three speeds: this distance times slow_rate(),
/// kSlowInResiduals times the residual of the last contact solution, and kSlowInRounding rounding errors of
/// the largest speed.
inline constexpr double kSlowInTolerances = 1e-2, kSlowInResiduals = 8, kSlowInRounding = 64;
/// A probe is a motion with this share of the length of the examined motion. It shows whether contacts that
/// stick at the start of the probe begin to slip.
inline constexpr double kProbe = 1e-3;
/// A contact slips in a probe if its speed at the end exceeds End::allowed_slip. This bound contains the
/// speed at the start, which is not zero if the contact point moves on the part. The bound also contains
/// kProbeSlip times the largest contact velocity without impulses.
inline constexpr double kProbeSlip = 1e-7;
/// Sticking contacts whose mean friction in a motion is at most this share of the largest friction are not
/// probed. If the friction grows linearly from zero, it ends at twice its mean and does not reach the limit.
inline constexpr double kSafeUse = 0.45;
/// The search for the time at which slip begins accepts a time at which slip_acceleration() is at most this
/// share of its value at the end of the searched motion.
inline constexpr double kSlipTolerance = 1e-6;
/// Loads are constant if accelerations at the start and at the share kSampledLoads of the motion differ by at
/// most kEqualLoads times the largest acceleration.
inline constexpr double kSampledLoads = 0.618, kEqualLoads = 1e-9;
/// Accuracy of the time of an event, as a share of the motion.
inline constexpr double kTimeTolerance = 1e-14;
/// locate_end() treats values of the function up to this share of its target as zero.
inline constexpr double kZero = 0.1;
/// Largest number of trial times of a search, and of halvings that look for a time before the event.
inline constexpr int kMaxTrials = 80, kMaxHalvings = 20;

/// An interval of times, s. A function is positive at `inside`, where its value is `value`, and not positive
/// at `outside`; either may be the later time.
struct Interval {
  double inside, value, outside;
};

/// Returns the time at which a function of time ceases to be positive: a time at which its value is near
/// `target`, or the end `outside` of an interval of length `accuracy`. Beyond the time sought the function is
/// negative, or zero within rounding, so the search alternates between secants through positive values and
/// halvings. Values up to kZero times `target` are treated as zero.
template <class F>
double locate_end(Interval interval, double target, double accuracy, F&& function) {
  double last = 0, last_value = 0;
  bool has_last = false;
  for (int i = 0; i < kMaxTrials && std::abs(interval.outside - interval.inside) > accuracy; ++i) {
    auto& [inside, value, outside] = interval;
    double tau = 0.5 * (inside + outside);
    if (has_last && i % 3 != 0) {
      const double secant = inside + (0.5 * target - value) * (inside - last) / (value - last_value);
      if ((secant - inside) * (secant - outside) < 0) tau = secant;
    }
    const double now = function(tau);
    if (!(now > kZero * target)) {
      outside = tau;
      continue;
    }
    last = std::exchange(inside, tau);
    last_value = std::exchange(value, now);
    has_last = true;
    if (now <= target) return inside;
  }
  return interval.outside;
}

/// Returns the linear speed of a part plus its angular speed times its size, m/s.
inline double speed(const PartModel& m, const VecX<double>& v) {
  return v.segment<3>(m.v0).norm() + m.size * v.segment<3>(m.v0 + 3).norm();
}

/// Returns the largest entry of the accelerations of all parts, m/s^2.
inline double largest(const Model& model, const VecX<double>& v_dot) {
  double largest = 0;
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    largest = std::max(largest, largest_speed(m, v_dot.segment(m.v0, 6 + m.n_s)));
    if (m.n_d() > 0)
      largest = std::max(
          largest,
          local_levers(m).cwiseProduct(v_dot.segment(m.v0 + 6 + m.n_s, m.n_d())).lpNorm<Eigen::Infinity>());
  }
  return largest;
}

inline Vec3<double> tangential(const Vec3<double>& u, const Contact& contact) {
  return u - u.dot(contact.normal) * contact.normal;
}

/// Returns whether a contact can have events: it has friction, and its sides are not at nodes of a mesh.
inline bool has_events(const Contact& contact) {
  return contact.friction > 0 && !contact.a.at_nodes() && !contact.b.at_nodes();
}

}  // namespace friction_events

PLIANT_INLINE FrictionEvents::FrictionEvents(const Dynamics& dynamics, const ContactFinder& finder,
                                             RestingContacts& resting, const ContactResolution& resolution,
                                             const Sleeping& sleeping)
    : dynamics_(dynamics), finder_(finder), resting_(resting), resolution_(resolution), sleeping_(sleeping) {}

PLIANT_INLINE std::optional<double> FrictionEvents::first(const Examined& motion, double tolerance) {
  find_starts(motion, tolerance);
  if (starts_.empty()) return std::nullopt;
  if (work_.parts.empty())
    dynamics_.accelerations(motion.free.begin, motion.free.before.q, motion.free.before.v, motion.free.before,
                            work_);
  if (method_ == nullptr) method_ = make_integrator(motion.method.name());
  Trial end{motion.free, motion.step.state, motion.contacts, {}};
  resolve(motion, motion.resting, end);
  drop_short_slides(motion, end);
  const bool probes = must_probe(motion, end);
  if (probes) find_directions(motion);
  const std::optional<double> stopped = stop(motion, end);
  std::optional<double> slipped;
  if (probes) slipped = slip(motion, stopped ? trial(motion, *stopped) : end);
  const std::optional<double> event = slipped ? slipped : stopped;
  const double shortest =
      16 * std::numeric_limits<double>::epsilon() * std::max(std::abs(motion.free.end()), motion.free.h);
  return event && *event > shortest && *event < motion.free.h - shortest ? event : std::nullopt;
}

/// Finds the contacts at the start of the motion that can have events, the directions in which they slide,
/// and the speed up to which they stick.
PLIANT_INLINE void FrictionEvents::find_starts(const Examined& motion, double tolerance) {
  starts_.clear();
  const FreeMotion& free = motion.free;
  const Model& model = dynamics_.model();
  double size = std::numeric_limits<double>::infinity(), fastest = 0;
  for (const Contact& contact : motion.resting) {
    if (!friction_events::has_events(contact)) continue;
    const Vec3<double> u = friction_events::tangential(finder_.velocity(free.before, contact), contact);
    starts_.push_back({key_of(contact), u.norm(), offset(contact, free.before, free.begin), u.normalized()});
    size = std::min(size, smaller_size(model, contact));
    fastest = std::max(fastest, contact.prescribed_velocity.norm());
    for (const ContactSide* side : {&contact.a, &contact.b})
      if (side->part >= 0 && model.parts()[at(side->part)].q0 >= 0)
        fastest = std::max(fastest, friction_events::speed(model.parts()[at(side->part)], free.before.v));
  }
  short_ = friction_events::kSlowInTolerances * tolerance * size;
  slow_ = slow_rate(model) * short_ + friction_events::kSlowInResiduals * free.before.contact_residual +
          friction_events::kSlowInRounding * std::numeric_limits<double>::epsilon() * fastest;
  for (Start& start : starts_)
    if (start.speed <= slow_) start.direction.setZero();
}

/// Treats contacts as sticking from the start if they stick at the end of the motion, and if they slide by at
/// most short_ (m). The Richardson extrapolation at the end of an earlier step (step_doubling-inl.h) leaves
/// such small speeds.
PLIANT_INLINE void FrictionEvents::drop_short_slides(const Examined& motion, const Trial& end) {
  for (const End& e : end.ends)
    if (starts_[at(e.start)].speed * motion.free.h <= short_ && e.slip.norm() <= slow_)
      starts_[at(e.start)].direction.setZero();
}

PLIANT_INLINE Vec3<double> FrictionEvents::offset(const Contact& contact, const State& state,
                                                  double t) const {
  return contact.x - dynamics_.model().position(state, contact.a.part, t);
}

/// Returns the number of the nearest contact of the same pair at the start of the motion; -1 if there is
/// none.
PLIANT_INLINE int FrictionEvents::start_of(const Contact& contact, const State& state, double t) const {
  const Vec3<double> x = offset(contact, state, t);
  int nearest = -1;
  double distance = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < starts_.size(); ++i)
    if (const double d = (starts_[i].offset - x).norm(); starts_[i].pair == key_of(contact) && d < distance) {
      distance = d;
      nearest = static_cast<int>(i);
    }
  return nearest;
}

/// Returns the motion of h seconds from a state and a time (s), with its contact impulses. resting: contacts
/// that rest at its start.
PLIANT_INLINE FrictionEvents::Trial FrictionEvents::trial(const Examined& motion, const State& from,
                                                          double begin, double h,
                                                          const std::vector<Contact>& resting) {
  Trial result{motion.free, from, {}, {}};
  set_step(result.state, begin, h);
  result.free.before = result.state;
  result.free.begin = begin;
  result.free.h = h;
  StepContext step(dynamics_, result.state, work_, motion.step.counters);
  method_->step(step);
  sleeping_.restore(result.state);
  result.contacts = resting_.contacts_after(result.free, resting, result.state);
  resolve(motion, resting, result);
  return result;
}

/// Returns the trial motion that consists of the first tau seconds of the motion.
PLIANT_INLINE FrictionEvents::Trial FrictionEvents::trial(const Examined& motion, double tau) {
  return trial(motion, motion.free.before, motion.free.begin, tau, motion.resting);
}

/// Returns a short motion from the end of another motion. At a kink (Model::next_kink) the short motion has
/// the loads before the kink, because the loads after the kink act in the next step only.
PLIANT_INLINE FrictionEvents::Trial FrictionEvents::probe(const Examined& motion, const Trial& from) {
  const Model& model = dynamics_.model();
  const double h = friction_events::kProbe * motion.free.h, end = from.free.end();
  const double after = std::max(end - h, motion.free.begin);
  const bool at_kink = model.may_have_kinks() && std::isfinite(model.next_kink(after, end + h).time);
  return trial(motion, from.state, at_kink ? end - h : end, h, from.contacts);
}

/// Returns the tangential speed of a contact of a trial motion at the start of this motion, m/s. resting: the
/// contacts at that time; they have the prescribed velocity of that time.
PLIANT_INLINE double FrictionEvents::slip_before(const FreeMotion& free, const std::vector<Contact>& resting,
                                                 const Contact& contact) const {
  Contact before = contact;
  double distance = std::numeric_limits<double>::infinity();
  for (const Contact& other : resting)
    if (const double d = (other.x - contact.x).norm(); key_of(other) == key_of(contact) && d < distance) {
      distance = d;
      before.prescribed_velocity = other.prescribed_velocity;
    }
  return friction_events::tangential(finder_.velocity(free.before, before), before).norm();
}

/// Computes the impulses at the contacts at the end of a motion, and applies them. resting: the contacts at
/// its start. The search for the impulses starts from the contact cache, as in the step itself.
PLIANT_INLINE void FrictionEvents::resolve(const Examined& motion, const std::vector<Contact>& resting,
                                           Trial& trial) {
  State& state = trial.state;
  const FreeMotion& free = trial.free;
  if (trial.contacts.empty()) return;
  time_impacts(finder_, free, state, trial.contacts);
  evaluate_touched(dynamics_, state, free.end(), trial.contacts, work_);
  ContactProblem problem(dynamics_.model(), state, work_, trial.contacts, &motion.free.before);
  double fastest = 0;
  for (const Vec3<double>& u : problem.velocities(state)) fastest = std::max(fastest, u.norm());
  resolution_.warm_start(motion.free.before, free.end(), free.h, trial.contacts, problem);
  const ContactSolution solution = problem.solve(free.force_time());
  motion.step.counters.contact_sweeps += solution.sweeps;
  motion.step.counters.contact_fallbacks += solution.fallbacks;
  for (std::size_t k = 0; k < trial.contacts.size(); ++k) {
    const Contact& contact = trial.contacts[k];
    const Vec3<double>& p = solution.impulse[k];
    const double p_n = p.dot(contact.normal);
    const int start = start_of(contact, state, free.end());
    if (start < 0 || !friction_events::has_events(contact) || !(p_n > 0)) continue;
    trial.ends.push_back({start, friction_events::tangential(solution.velocity[k], contact),
                          friction_events::tangential(p, contact).norm() / (contact.friction * p_n),
                          slip_before(free, resting, contact) + slow_ * free.h / motion.free.h +
                              friction_events::kProbeSlip * fastest +
                              friction_events::kSlowInResiduals * solution.residual});
  }
  problem.bound_shifts(free.force_time(), free.h);
  apply_solution(problem, dynamics_.model(), work_, state);
  StepContext at_end(dynamics_, state, work_, motion.step.counters, free.end(), free.h);
  resolution_.reconcile(at_end, parts_touched(dynamics_.model(), trial.contacts));
}

/// Returns whether a contact that sticks at the start of the motion slips at its end, or may begin to slip.
PLIANT_INLINE bool FrictionEvents::must_probe(const Examined& motion, const Trial& end) {
  bool slips = false, may_slip = false;
  for (const End& e : end.ends) {
    if (starts_[at(e.start)].slides()) continue;
    slips = slips || e.slip.norm() > slow_;
    may_slip = may_slip || e.use > friction_events::kSafeUse;
  }
  return slips || (may_slip && !are_forces_constant(motion));
}

/// Returns whether bodies at the contacts were at rest at the start of the motion and the loads on them do
/// not change: then the forces of contact do not change either.
PLIANT_INLINE bool FrictionEvents::are_forces_constant(const Examined& motion) {
  const Model& model = dynamics_.model();
  const FreeMotion& free = motion.free;
  const State& before = free.before;
  if (has_prescribed_motion(model, motion.resting)) return false;
  const std::vector<int> parts = parts_touched(model, motion.resting);
  if (std::any_of(parts.begin(), parts.end(),
                  [&](int i) { return friction_events::speed(model.parts()[at(i)], before.v) > slow_; }))
    return false;
  dynamics_.accelerations(free.begin, before.q, before.v, before, work_);
  const VecX<double> v_dot = work_.v_dot;
  dynamics_.accelerations(free.begin + friction_events::kSampledLoads * free.h, before.q, before.v, before,
                          work_);
  motion.step.counters.evaluations += 2;
  return friction_events::largest(model, work_.v_dot - v_dot) <=
         friction_events::kEqualLoads * friction_events::largest(model, v_dot);
}

/// Finds the contacts that begin to slip at the start of the motion, and sets their directions of sliding.
PLIANT_INLINE void FrictionEvents::find_directions(const Examined& motion) {
  const Trial begin = trial(motion, friction_events::kProbe * motion.free.h);
  for (const End& e : begin.ends)
    if (starts_[at(e.start)].sticks() && e.slip.norm() > e.allowed_slip)
      starts_[at(e.start)].direction = e.slip.normalized();
}

/// Returns the least speed of sliding contacts in the directions in which they slid at the start of the
/// motion, m/s; infinity if no contact slid.
PLIANT_INLINE double FrictionEvents::least_sliding(const Trial& trial) const {
  double least = std::numeric_limits<double>::infinity();
  for (const End& e : trial.ends)
    if (starts_[at(e.start)].slides()) least = std::min(least, starts_[at(e.start)].direction.dot(e.slip));
  return least;
}

/// Returns the time from the start of the motion until a sliding contact stops or reverses, s; std::nullopt
/// if no contact does so before `end`, the end of the motion.
PLIANT_INLINE std::optional<double> FrictionEvents::stop(const Examined& motion, const Trial& end) {
  auto sliding = [&](double tau) { return least_sliding(trial(motion, tau)); };
  const double h = motion.free.h, target = 0.5 * slow_;
  if (least_sliding(end) > target) return std::nullopt;
  friction_events::Interval interval{0, 0, h};
  for (int i = 0; i < friction_events::kMaxHalvings; ++i) {
    const double tau = 0.5 * interval.outside, value = sliding(tau);
    if (value > target) {
      interval.inside = tau;
      interval.value = value;
      break;
    }
    interval.outside = tau;
  }
  if (!(interval.value > 0)) return std::nullopt;
  return friction_events::locate_end(interval, target, friction_events::kTimeTolerance * h, sliding);
}

/// Returns the largest acceleration with which sticking contacts begin to slip after a trial motion, m/s^2,
/// or 0. The slip that a probe allows is subtracted, so that the result is continuous where slip begins.
PLIANT_INLINE double FrictionEvents::slip_acceleration(const Examined& motion, const Trial& trial) {
  const Trial after = probe(motion, trial);
  double fastest = 0;
  for (const End& e : after.ends)
    if (starts_[at(e.start)].sticks() && e.slip.norm() > e.allowed_slip)
      fastest = std::max(fastest, (e.slip.norm() - e.allowed_slip) / after.free.h);
  return fastest;
}

/// Returns the time from the start of the motion until a sticking contact begins to slip, s; std::nullopt if
/// no contact does so before the end of the trial motion `end`.
PLIANT_INLINE std::optional<double> FrictionEvents::slip(const Examined& motion, const Trial& end) {
  const bool any_stick =
      std::any_of(starts_.begin(), starts_.end(), [](const Start& s) { return s.sticks(); });
  if (!any_stick) return std::nullopt;
  const double at_end = slip_acceleration(motion, end);
  if (!(at_end > 0)) return std::nullopt;
  auto acceleration = [&](double tau) { return slip_acceleration(motion, trial(motion, tau)); };
  return friction_events::locate_end({end.free.h, at_end, 0}, friction_events::kSlipTolerance * at_end,
                                     friction_events::kTimeTolerance * motion.free.h, acceleration);
}

}  // namespace pliant
