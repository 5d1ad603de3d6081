// Function bodies of contact_stepping.h: the stages of a step with contact. ContactStepping::step() lists
// them, and the README.md of this folder describes them.
#pragma once

#include <pliant/contact/contact_stepping.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include <pliant/body/step_failure.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/impact_timing.h>
#include <pliant/contact/predicted_impulses.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace contact_stepping {

/// Rebounds slower than this are ignored (FreeMotion::min_impact_speed). Unit: the speed that gravity gives a
/// body in a step.
inline constexpr double kMinImpactSpeed = 1e-3;
/// If impulses are predicted, contacts without restitution rest up to this normal speed, in the unit of
/// kMinImpactSpeed. Rolling causes a normal speed of second order in the length of the step.
inline constexpr double kMaxInelasticSpeed = 0.1;
/// Contacts rest at speeds up to this multiple of the residual of the last contact solution, at most up
/// to the speed that gravity gives a body in a step.
inline constexpr double kResidualFactor = 8;
/// Impacts are located if at most kMaxLocatedPairs pairs meet in a motion, in models with few moving parts
/// (Model::has_few_moving_parts). To locate an impact, the step of all parts is repeated several times.
inline constexpr std::size_t kMaxLocatedPairs = 3;
/// The step fails if the longest motion in which no part passes through another is at most 1 / kMaxMotions of
/// the rest of the step.
inline constexpr double kMaxMotions = 1e4;
/// In a cluster (a model of some parts of a body) changes of friction are located only for tolerances below
/// this. For other tolerances step doubling alone controls the error, because this takes only a third of the
/// time for heaps.
inline constexpr double kFrictionTolerance = 1e-4;
/// Largest number of impacts that are located in a step. Later impacts act at the ends of their motions.
inline constexpr int kMaxLocatedImpacts = 200;
/// At the time of a located impact, other pairs may touch, too. If such a pair did not rest before, it
/// touches if its gap is at most this share of the largest gap of a resting contact.
inline constexpr double kTouchingGap = 1e-6;

/// With a tolerance, residual_speed() is zero up to this speed, in the unit of kMinImpactSpeed; without a
/// tolerance, up to kMinImpactSpeed. The bound is lower with a tolerance, because in a long step even a slow
/// residual leaves a gap at a resting contact, and RestingContacts::widen_gap() must allow this gap.
inline constexpr double kMinResidualSpeed = 1e-5;

/// Returns the normal speed of resting contacts that the residual of the last contact solution (m/s) causes,
/// m/s. The result is rounded down to a power of two, so that it rarely changes and the result of the last
/// contact search stays valid. The result is 0 if the speed is at most min_share times gravity_speed.
/// gravity_speed: speed that gravity gives a body in the step, m/s.
inline double residual_speed(double residual, double gravity_speed, double min_share) {
  const double speed = std::min(kResidualFactor * residual, gravity_speed);
  if (!(speed > min_share * gravity_speed)) return 0;
  int exponent = 0;
  std::frexp(speed, &exponent);
  return std::ldexp(1.0, exponent - 1);
}

}  // namespace contact_stepping

PLIANT_INLINE ContactStepping::ContactStepping(const Dynamics& dynamics, const ContactFinder* whole)
    : dynamics_(dynamics),
      finder_(whole == nullptr ? ContactFinder(dynamics.model()) : ContactFinder(dynamics.model(), *whole)),
      meshes_(dynamics.model(), finder_.obstacles()),
      resting_(dynamics.model(), finder_),
      resolution_(dynamics, finder_, meshes_, resting_, record_),
      impact_sequence_(finder_, resolution_),
      sleeping_(dynamics, resting_, meshes_),
      friction_events_(dynamics, finder_, resting_, resolution_, sleeping_) {
  for (ContactRecord* record : {&record_, &record_before_})
    record->joint_impulses.setZero(dynamics.model().n_rows());
  few_parts_ = dynamics.model().has_few_moving_parts();
}

PLIANT_INLINE void ContactStepping::begin_step() {
  resting_at_start_.clear();
  has_unlocated_ = false;
  at_friction_event_ = false;
  std::swap(record_, record_before_);
  record_.clear();
  recorded_ = 0;
}

PLIANT_INLINE void ContactStepping::absorb(ContactStepping& cluster) {
  const Model &some = cluster.dynamics_.model(), &all = dynamics_.model();
  const ContactRecord& of_cluster = cluster.record_;
  for (Contact contact : of_cluster.contacts) {
    for (ContactSide* side : {&contact.a, &contact.b})
      if (side->part >= 0) side->part = some.part_numbers()[at(side->part)];
    record_.contacts.push_back(std::move(contact));
  }
  auto append = [](const auto& from, auto& to) { to.insert(to.end(), from.begin(), from.end()); };
  append(of_cluster.impulses, record_.impulses);
  append(of_cluster.sliding, record_.sliding);
  append(of_cluster.time, record_.time);
  for (std::size_t j = 0; j < some.joints().size(); ++j) {
    const JointModel &from = some.joints()[j], &to = all.joints()[at(some.joint_numbers()[j])];
    record_.joint_impulses.segment(to.row, to.rows) += of_cluster.joint_impulses.segment(from.row, from.rows);
  }
  const StageTimes times = std::exchange(cluster.times_, {});
  times_.motion += times.motion;
  times_.finding += times.finding;
  times_.resolution += times.resolution;
}

PLIANT_INLINE void ContactStepping::undo_step() {
  std::swap(record_, record_before_);
}

PLIANT_INLINE std::vector<Contact> ContactStepping::overlaps(const State& state, double t) const {
  std::vector<Contact> found = finder_.find(state, t, 0);
  meshes_.find(state, t, found);
  return found;
}

/// Measures the time of the stages, one after the other.
class ContactStepping::StageClock {
 public:
  void lap(double& stage) {
    const Clock::time_point now = Clock::now();
    stage += std::chrono::duration<double>(now - last_).count();
    last_ = now;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

/// The progress of a step, and the length of its next motion.
struct ContactStepping::Progress {
  Integrator& method;
  StepContext& step;
  double begin, end, now;  ///< s
  double time_tolerance;   ///< times closer than this are equal, s
  double longest;  ///< largest length of the next motion, s; in a longer one, parts would move too far
  double min_impact_speed, max_resting_speed, max_inelastic_speed;  ///< see FreeMotion, m/s
  /// Whether a part that deforms locally came near another body although this was not predicted.
  bool soft_nearby;
  bool predicts;  ///< whether impulses of resting contacts are predicted
  int impacts;    ///< number of impacts located so far
  StageClock clock;

  bool finished() const { return !(now < end - time_tolerance); }
  /// Returns the displacement by gravity in a motion of h seconds, in units of gravity * h^2.
  double gravity_reach() const { return method.local_is_implicit() ? 1 : method.reach(); }
};

/// One motion of the method within a step, and the contacts that it may cause.
struct ContactStepping::Motion {
  FreeMotion free;
  ContactFinder::Neighbourhood predicted, travelled;  ///< predicted before the motion; found after it
  std::vector<Contact> resting;   ///< resting contacts at its start; those with predicted impulses are last
  std::vector<Contact> contacts;  ///< contacts at its end

  /// Whether no bodies come near each other.
  bool is_free() const { return predicted.empty && travelled.empty; }
};

PLIANT_INLINE double ContactStepping::step(Integrator& method, StepContext& step, double tolerance) {
  if (meshes_.empty() || !method.local_is_implicit()) return step_once(method, step, tolerance);
  const Before before{step.state, record_, recorded_, step.counters};
  soft_may_touch_ = false;
  const double length = step_once(method, step, tolerance);
  const bool whole = length == before.state.h && step.state.q.allFinite() && step.state.v.allFinite();
  if (soft_may_touch_ && whole && !has_deep_nodes(before.state))
    extrapolate_soft_step(method, step, before, length, tolerance);
  return length;
}

/// Performs the stages of a step.
PLIANT_INLINE double ContactStepping::step_once(Integrator& method, StepContext& step, double tolerance) {
  State& state = step.state;
  const double start = state.start, h = state.h;
  const std::int64_t number = state.step;
  Progress progress = begin(method, step, tolerance);
  double length = h;
  while (!progress.finished()) {
    Motion motion = advance(progress);                                      // 1 predict, 2 advance, 3 detect
    if (tolerance > 0) cut_at_friction_event(motion, progress, tolerance);  // 4 locate changes of friction
    if (!state.q.allFinite() || !state.v.allFinite()) break;                // the caller reports the failure
    if (motion.is_free()) {
      progress.now = motion.free.end();
      continue;
    }
    record_resting(motion, tolerance);
    const bool impact = locate_and_apply_impact(motion, progress);  // 5 locate the first impact
    if (!impact) {
      const std::size_t first = record_.contacts.size();
      resolve(motion, progress);  // 6 resolve, 7 correct
      if (tolerance > 0 && few_parts_) include_openings(first, progress.now, motion.free.h, state);
    }
    const bool event =
        impact ? progress.now > progress.begin : !progress.finished() && few_parts_ && has_contact_error();
    if (tolerance > 0 && event) {
      length = progress.now - progress.begin;
      break;
    }
  }
  state.start = start;
  state.step = number;
  state.h = h;
  recorded_ += length;
  record_.time.assign(record_.contacts.size(), recorded_);
  resolution_.end_step(length, state);
  sleeping_.fall_asleep(record_.contacts, progress.begin, length, state);  // 8 sleep
  return length;
}

PLIANT_INLINE ContactStepping::Progress ContactStepping::begin(Integrator& method, StepContext& step,
                                                               double tolerance) {
  State& state = step.state;
  const double h = state.h, begin = state.time(), end = begin + h;
  const double time_tolerance = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(end), h);
  const double gravity_speed = dynamics_.model().body().gravity_at(end).norm() * h,
               residual_speed = contact_stepping::residual_speed(
                   state.contact_residual, gravity_speed,
                   tolerance > 0 ? contact_stepping::kMinResidualSpeed : contact_stepping::kMinImpactSpeed),
               min_impact_speed = contact_stepping::kMinImpactSpeed * gravity_speed,
               max_resting_speed = std::max(min_impact_speed, residual_speed);
  state.contact_residual = 0;
  const bool predicts = tolerance == 0 && meshes_.empty() && method.reach() == 0.5 && !is_sequential();
  resolution_.begin_step(state, predicts);
  resting_.widen_gap(residual_speed * h);
  const double max_inelastic_speed =
      predicts ? std::max(max_resting_speed, contact_stepping::kMaxInelasticSpeed * gravity_speed)
               : max_resting_speed;
  return {method,
          step,
          begin,
          end,
          begin,
          time_tolerance,
          h,
          min_impact_speed,
          max_resting_speed,
          max_inelastic_speed,
          false,
          predicts,
          0,
          {}};
}

/// Advances by one motion, which is as long as the contacts allow: a motion that was too long is repeated
/// shorter.
PLIANT_INLINE ContactStepping::Motion ContactStepping::advance(Progress& progress) {
  State& state = progress.step.state;
  for (;;) {
    Motion motion = predict(progress);
    StepContext step(dynamics_, state, progress.step.work, progress.step.counters);
    progress.method.step(step);
    sleeping_.restore(state);
    progress.clock.lap(times_.motion);
    if (!state.q.allFinite() || !state.v.allFinite()) return motion;
    const bool accepted = detect(motion, progress);
    progress.clock.lap(times_.finding);
    if (accepted) return motion;
  }
}

/// Stage 1: predicts which bodies the next motion brings near each other, and how long it may be.
/// Applies predicted impulses. Wakes sleeping parts whose Drive (sleeping.h) changes.
PLIANT_INLINE ContactStepping::Motion ContactStepping::predict(Progress& progress) {
  State& state = progress.step.state;
  const double now = progress.now, remaining = progress.end - now,
               length = std::min(remaining, progress.longest);
  sleeping_.begin_motion(now, remaining, state);
  Motion motion;
  motion.predicted = look_ahead(state, now, length, progress.gravity_reach(), progress.soft_nearby);
  if (!meshes_.empty()) progress.method.expect_touch(motion.predicted.soft);
  soft_may_touch_ = soft_may_touch_ || motion.predicted.soft;
  if (!(motion.predicted.h > remaining / contact_stepping::kMaxMotions)) fail_too_fast(progress);
  FreeMotion& free = motion.free;
  free.begin = now;
  free.h = motion.predicted.h >= remaining - progress.time_tolerance ? remaining : motion.predicted.h;
  free.reach = progress.method.reach();
  free.min_impact_speed = progress.min_impact_speed;
  free.max_resting_speed = progress.max_resting_speed;
  free.max_inelastic_speed = progress.max_inelastic_speed;
  if (!motion.predicted.empty) motion.resting = resting_.at_rest(state, now, free);
  free.h = resting_.longest(free, motion.resting, dynamics_.model().body().gravity_at(now).norm());
  if (now != state.time() || free.h != state.h) set_step(state, now, free.h);
  progress.clock.lap(times_.finding);
  if (progress.predicts && !motion.resting.empty()) {
    apply_predicted_impulses({progress.step, finder_, resolution_}, free, motion.resting);
    progress.clock.lap(times_.resolution);
  }
  free.before = state;
  return motion;
}

PLIANT_INLINE void ContactStepping::fail_too_fast(const Progress& progress) const {
  const State& state = progress.step.state;
  double fastest = -1;  // sizes per second
  std::ostringstream message;
  for (const PartModel& m : dynamics_.model().parts()) {
    if (m.q0 < 0) continue;
    const double speed = state.v.segment<3>(m.v0).norm(),
                 rate = speed / m.size + state.v.segment<3>(m.v0 + 3).norm();
    if (rate <= fastest) continue;
    fastest = rate;
    message.str("");
    message << "part '" << m.part->name() << "' moves at " << speed << " m/s and turns at "
            << state.v.segment<3>(m.v0 + 3).norm() << " rad/s";
  }
  message << ", so fast that the step would need more than " << contact_stepping::kMaxMotions
          << " pieces in which no part passes through another";
  throw NumericalFailure(message.str(), progress.now);
}

/// Stage 3: finds the contacts at the end of the motion, and assigns predicted impulses to them. Returns
/// false, and restores the state at the start of the motion, in four cases: the motion was too long; it woke
/// sleeping parts; it brought a part that deforms locally near another body, which was not predicted;
/// impulses were predicted and an impact is to be located.
PLIANT_INLINE bool ContactStepping::detect(Motion& motion, Progress& progress) {
  State& state = progress.step.state;
  const FreeMotion& free = motion.free;
  auto repeat = [&](double longest) {
    progress.longest = longest;
    state = free.restart();
    return false;
  };
  motion.travelled = finder_.neighbourhood_of(free.before, state, free.begin, free.h,
                                              progress.gravity_reach(), motion.predicted);
  if (!meshes_.empty())
    meshes_.approach(free.before, &state, free.begin, free.h, progress.gravity_reach(), motion.travelled);
  progress.soft_nearby = motion.travelled.soft && !motion.predicted.soft;
  if (progress.soft_nearby || motion.travelled.h < free.h - progress.time_tolerance)
    return repeat(std::min(motion.travelled.h, free.h));
  progress.longest = std::max(progress.longest, 2 * free.h);
  if (motion.is_free()) return true;
  const double longest = resting_.longest(free, motion.resting, state);
  if (longest < free.h - progress.time_tolerance) return repeat(longest);
  motion.contacts = resting_.contacts_after(free, motion.resting, state);
  if (free.has_predicted() && !complete_prediction(motion, progress)) return repeat(free.h);
  return !wake_touched(motion.contacts, free, state);
}

/// Assigns the predicted impulses of a motion to the contacts at its end, and subtracts the predicted
/// impulses of pairs that no longer touch. Returns false if an impact is to be located: the motion is to be
/// repeated, and the rest of the step predicts no impulses.
PLIANT_INLINE bool ContactStepping::complete_prediction(Motion& motion, Progress& progress) {
  for (;;) {
    if (!impacts_to_locate(motion).empty()) {
      progress.predicts = false;
      return false;
    }
    std::vector<Contact> lost = assign_predicted_impulses(motion.resting, motion.contacts);
    if (lost.empty()) return true;
    take_back_predicted_impulses({progress.step, finder_, resolution_}, motion.free, std::move(lost));
    motion.contacts = resting_.contacts_after(motion.free, motion.resting, progress.step.state);
  }
}

/// Returns the neighbourhood of a motion of at most `length` seconds from the time `now`. gravity_reach: see
/// Progress. soft_nearby: whether parts that deform locally are known to come near another body.
PLIANT_INLINE ContactFinder::Neighbourhood ContactStepping::look_ahead(const State& state, double now,
                                                                       double length, double gravity_reach,
                                                                       bool soft_nearby) {
  ContactFinder::Neighbourhood around = finder_.neighbourhood(state, now, length, gravity_reach);
  if (meshes_.empty()) return around;
  meshes_.approach(state, nullptr, now, length, gravity_reach, around);
  around.soft = around.soft || soft_nearby;
  return around;
}

/// If a sleeping part is at a contact, restores the state at the start of the motion and wakes the part.
/// Returns whether a part was woken.
PLIANT_INLINE bool ContactStepping::wake_touched(const std::vector<Contact>& contacts,
                                                 const FreeMotion& motion, State& state) {
  if (!sleeping_.any_asleep()) return false;
  std::vector<Contact> mesh_contacts;
  meshes_.find(state, motion.end(), mesh_contacts);
  if (!sleeping_.touches_sleeping(contacts, state) && !sleeping_.touches_sleeping(mesh_contacts, state))
    return false;
  state = motion.restart();
  sleeping_.wake_touched(contacts, state);
  sleeping_.wake_touched(mesh_contacts, state);
  return true;
}

/// Stage 4: ends the motion at the first change of friction at its resting contacts, in models with few
/// moving parts: the motion is repeated shorter.
PLIANT_INLINE void ContactStepping::cut_at_friction_event(Motion& motion, Progress& progress,
                                                          double tolerance) {
  if (!few_parts_ || motion.resting.empty() || motion.contacts.empty()) return;
  if (!dynamics_.model().is_whole() && tolerance >= contact_stepping::kFrictionTolerance) return;
  if (motion.predicted.soft || motion.travelled.soft) return;  // FrictionEvents finds no contacts at nodes
  const std::optional<double> event = friction_events_.first(
      {progress.method, progress.step, motion.free, motion.resting, motion.contacts}, tolerance);
  progress.clock.lap(times_.resolution);
  if (!event) return;
  progress.longest = *event;
  progress.step.state = motion.free.restart();
  motion = advance(progress);
  at_friction_event_ = motion.free.h == *event;
}

/// Records the resting contacts of a motion, for the error estimate of contact.
PLIANT_INLINE void ContactStepping::record_resting(const Motion& motion, double tolerance) {
  if (tolerance > 0 && few_parts_)
    resting_at_start_.insert(resting_at_start_.end(), motion.resting.begin(), motion.resting.end());
  else
    has_unlocated_ = has_unlocated_ || !motion.resting.empty();
}

/// Returns the impacts of the motion, one for each pair, if the model has few moving parts and at most
/// kMaxLocatedPairs pairs meet; otherwise an empty list.
PLIANT_INLINE std::vector<Contact> ContactStepping::impacts_to_locate(const Motion& motion) const {
  std::vector<Contact> impacts;
  if (!few_parts_) return impacts;
  const Pairs rest(motion.resting);
  for (const Contact& contact : motion.contacts) {
    if (rest.has(contact) || Pairs(impacts).has(contact)) continue;
    if (impacts.size() == contact_stepping::kMaxLocatedPairs) return {};
    impacts.push_back(contact);
  }
  return impacts;
}

/// Stage 5: cuts the motion at its first impact, if the impact can be located, and applies the impulses
/// there. Returns whether the motion was cut. locate_impact() is in impact_timing.h.
PLIANT_INLINE bool ContactStepping::locate_and_apply_impact(Motion& motion, Progress& progress) {
  StepCounters& counters = progress.step.counters;
  const std::vector<Contact> impacts = impacts_to_locate(motion);
  if (impacts.empty()) return false;
  if (progress.impacts == contact_stepping::kMaxLocatedImpacts) {
    ++counters.contact_cutoffs;
    return false;
  }
  const std::optional<double> tau =
      locate_impact(progress.step, finder_, progress.method, motion.free, impacts);
  sleeping_.restore(progress.step.state);
  progress.clock.lap(times_.motion);
  if (!tau) return false;
  ++progress.impacts;
  ++counters.impacts;
  motion.free.h = *tau;
  progress.now = motion.free.end();
  const StepResponses responses(progress.method, dynamics_.model(), progress.step.work);
  apply_impact(motion, impacts, progress);
  sleeping_.wake_moved(progress.step.state);
  return true;
}

/// Resolves the resting contacts at the end of a motion that an impact has cut. The impulses stand for forces
/// during this motion. New contacts of the pairs that rested, and overlaps of meshes, are included.
PLIANT_INLINE void ContactStepping::resolve_resting(const Motion& motion, StepContext& step,
                                                    StageClock& clock) {
  const FreeMotion& free = motion.free;
  const Pairs rest(motion.resting);
  std::vector<Contact> contacts = resting_.contacts_after(free, motion.resting, step.state);
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                [&](const Contact& c) { return c.since == 0 && !rest.has(c); }),
                 contacts.end());
  meshes_.find(step.state, step.t, contacts);
  time_impacts(finder_, free, step.state, contacts);
  clock.lap(times_.finding);
  resolution_.resolve(step, resolved_motion(free), contacts);
  clock.lap(times_.resolution);
}

/// Resolves the resting contacts of the motion, which was cut at an impact, and then applies the impulses of
/// this impact at the end of the motion.
PLIANT_INLINE void ContactStepping::apply_impact(const Motion& motion, const std::vector<Contact>& impacts,
                                                 Progress& progress) {
  const FreeMotion& free = motion.free;
  const Pairs rest(motion.resting), impact_pairs(impacts);
  State& state = progress.step.state;
  StepContext step(dynamics_, state, progress.step.work, progress.step.counters, free.end(), free.h);
  resolve_resting(motion, step, progress.clock);
  std::vector<Contact> contacts = finder_.find(state, step.t, resting_.gap());
  resting_.add_followed(motion.resting, resting_.gap(), contacts);
  contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                [&](const Contact& c) {
                                  const double gap = resting_.gap(c);
                                  return c.gap > gap || (c.gap > contact_stepping::kTouchingGap * gap &&
                                                         !rest.has(c) && !impact_pairs.has(c));
                                }),
                 contacts.end());
  if (is_sequential()) {  // impacts that the sequence leaves have no rebound
    impact_sequence_.resolve(step, contacts, 0, free.min_impact_speed);
  } else {
    for (Contact& contact : contacts) {
      const double rebound = -contact.restitution * finder_.velocity(state, contact).dot(contact.normal);
      if (!rest.has(contact) && rebound > free.min_impact_speed) contact.rebound = rebound;
    }
  }
  progress.clock.lap(times_.finding);
  resolution_.resolve(step, {state, 0, 0}, contacts);
  progress.clock.lap(times_.resolution);
}

/// Resolves the impacts at the contacts of the motion in sequence, at its end: first the resting contacts,
/// whose impulses stand for forces, and then the impacts, which these contacts transmit. Impacts that remain
/// have no rebound. Without restitution, or without an impact faster than FreeMotion::min_impact_speed, there
/// is no sequence.
PLIANT_INLINE void ContactStepping::resolve_sequence(Motion& motion, StepContext& step) {
  const FreeMotion& free = motion.free;
  const Pairs rest(motion.resting);
  std::vector<Contact> resting, impacts = motion.contacts;
  auto is_impact = [&](const Contact& contact) {
    return contact.gap < 0 &&
           -finder_.velocity(step.state, contact).dot(contact.normal) > free.min_impact_speed;
  };
  double since_first = 0;  // time since the first impact, s
  bool any_rebound = false;
  for (const Contact& contact : motion.contacts) {
    any_rebound = any_rebound || contact.restitution > 0;
    if (rest.has(contact))
      resting.push_back(contact);
    else if (is_impact(contact))
      since_first = std::max(since_first, contact.since);
  }
  if (since_first == 0 || !any_rebound) return;
  resolution_.resolve(step, resolved_motion(free, false), resting);
  for (Contact& contact : impacts) {
    contact.rebound = 0;
    if (rest.has(contact))
      contact.since = since_first;
    else if (is_impact(contact))
      contact.rebound = (1 + contact.restitution) * gained_velocity(finder_, free, step.state, contact);
  }
  impact_sequence_.resolve(step, impacts, free.h, free.min_impact_speed);
  for (Contact& contact : motion.contacts) contact.rebound = 0;
}

/// Stages 6 and 7: applies the impulses at the contacts at the end of the motion, and separates the overlaps
/// that remain.
PLIANT_INLINE void ContactStepping::resolve(Motion& motion, Progress& progress) {
  const FreeMotion& free = motion.free;
  std::vector<Contact>& contacts = motion.contacts;
  State& state = progress.step.state;
  progress.now = free.end();
  StepContext step(dynamics_, state, progress.step.work, progress.step.counters, progress.now, free.h);
  const StepResponses responses(progress.method, dynamics_.model(), step.work);
  meshes_.find(state, progress.now, contacts);
  time_impacts(finder_, free, state, contacts);
  // An implicit step moves a node by h times the velocity at its end. A change of this velocity by an impulse
  // therefore moves the node by h times the change.
  if (progress.method.local_is_implicit())
    for (Contact& contact : contacts)
      if (is_at_nodes(contact)) contact.since = free.force_time();
  has_unlocated_ = has_unlocated_ || !contacts.empty();
  progress.clock.lap(times_.finding);
  if (is_sequential()) resolve_sequence(motion, step);
  resolution_.resolve(step, resolved_motion(free), contacts);
  resolution_.resolve_chain(step, std::move(contacts), free.min_impact_speed);
  sleeping_.wake_moved(state);
  progress.clock.lap(times_.resolution);
}

}  // namespace pliant
