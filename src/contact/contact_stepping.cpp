#include <pliant/contact/contact_stepping.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include <pliant/body/step_failure.h>
#include <pliant/contact/impact_timing.h>
#include <pliant/math/index.h>

#include <pliant/contact/contact_pairs.h>

namespace pliant {

namespace {

/// Impacts below this speed, in units of the velocity by gravity in a step, do not rebound.
constexpr double kSlowImpact = 1e-3;
/// Speed of resting contacts in the next step, in units of the residual of the impulses, at most the velocity
/// by gravity.
constexpr double kLoose = 8;
/// Most pairs whose impacts in one step are located, because each trial repeats the step of all parts, and
/// most moving parts for which this pays.
constexpr std::size_t kMaxLocatedPairs = 3;
constexpr std::ptrdiff_t kMaxLocatedParts = 8;
/// Most motions in a step; motions are short enough that no body passes through another.
constexpr double kMaxMotions = 1e4;
constexpr int kMaxLocatedImpacts = 200;
/// At a located impact surfaces touch within this share of the gap of resting contacts.
constexpr double kTouchingGap = 1e-6;

/// Returns the largest speed of resting contacts after a residual, m/s, rounded to a power of two, so that
/// the last search is mostly still valid.
double loose_speed(double residual, double falls) {
  const double left = std::min(kLoose * residual, falls);
  if (!(left > kSlowImpact * falls)) return 0;
  int exponent = 0;
  std::frexp(left, &exponent);
  return std::ldexp(1.0, exponent - 1);
}

}  // namespace

ContactStepping::ContactStepping(const Dynamics& dynamics)
    : dynamics_(dynamics),
      finder_(dynamics.model()),
      meshes_(dynamics.model(), finder_.obstacles()),
      resting_(dynamics.model(), finder_),
      resolution_(dynamics, finder_, meshes_, resting_, record_),
      sleeping_(dynamics, resting_, meshes_) {
  for (ContactRecord* record : {&record_, &record_before_})
    record->joint_impulses.setZero(dynamics.model().n_rows());
  few_parts_ = std::count_if(dynamics.model().parts().begin(), dynamics.model().parts().end(),
                             [](const PartModel& m) { return m.q0 >= 0; }) <= kMaxLocatedParts;
}

void ContactStepping::begin_step() {
  rested_.clear();
  meets_late_ = false;
  std::swap(record_, record_before_);
  record_.clear();
}

void ContactStepping::undo_step() {
  std::swap(record_, record_before_);
}

std::vector<Contact> ContactStepping::overlaps(const State& state, double t) const {
  std::vector<Contact> found = finder_.find(state, t, 0);
  meshes_.find(state, t, found);
  return found;
}

/// Measures how long the stages take, one after the other.
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

/// How far a step has come, and how long its next motion may be.
struct ContactStepping::Progress {
  Integrator& method;
  StepContext& step;
  double begin, end, now;  ///< s
  double near;             ///< times closer than this are equal, s
  double longest;          ///< longest next motion, s: in a longer one parts travelled farther than predicted
  double slow, loose;      ///< as in FreeMotion, m/s
  bool soft_nearby;        ///< whether parts that deform locally came near something that was not predicted
  int impacts;             ///< located so far
  StageClock clock;

  bool finished() const { return !(now < end - near); }
  /// Shares of gravity that the motion adds to the travel of parts.
  double fall() const { return method.local_is_implicit() ? 1 : method.reach(); }
};

/// One motion of the method within a step, with the surfaces that it may bring together.
struct ContactStepping::Motion {
  FreeMotion free;
  ContactFinder::Neighbourhood predicted, travelled;
  std::vector<Contact> resting;   ///< contacts at rest at its start
  std::vector<Contact> contacts;  ///< contacts at its end

  bool meets_nothing() const { return predicted.empty && travelled.empty; }
};

double ContactStepping::step(Integrator& method, StepContext& step, bool to_event) {
  State& state = step.state;
  const double start = state.start, h = state.h;
  const std::int64_t number = state.step;
  Progress progress = begin(method, step);
  double taken = h;
  while (!progress.finished()) {
    Motion motion = advance(progress);                        // 1 predict, 2 advance, 3 detect
    if (!state.q.allFinite() || !state.v.allFinite()) break;  // the caller reports it
    if (motion.meets_nothing()) {
      progress.now = motion.free.end();
      continue;
    }
    record_resting(motion, to_event);
    const bool struck = locate_and_strike(motion, progress);  // 4 locate the first impact
    if (!struck) resolve(motion, progress);                   // 5 resolve, 6 correct
    const bool event =
        struck ? progress.now > progress.begin : !progress.finished() && few_parts_ && any_resting();
    if (to_event && event) {
      taken = progress.now - progress.begin;
      break;
    }
  }
  state.start = start;
  state.step = number;
  state.h = h;
  resolution_.end_step(taken, state);
  sleeping_.fall_asleep(record_.contacts, progress.begin, taken, state);  // 7 sleep
  return taken;
}

ContactStepping::Progress ContactStepping::begin(Integrator& method, StepContext& step) {
  State& state = step.state;
  const double h = state.h, begin = state.time(), end = begin + h;
  const double near = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(end), h);
  const double falls = dynamics_.model().body().gravity_at(end).norm() * h,
               left = loose_speed(state.contact_residual, falls), slow = kSlowImpact * falls;
  state.contact_residual = 0;
  resolution_.begin_step(state);
  resting_.loosen(left * h);
  return {method, step, begin, end, begin, near, h, slow, std::max(slow, left), false, 0, {}};
}

/// Advances by one motion, as long as the surfaces allow: motions that turn out too long are repeated
/// shorter.
ContactStepping::Motion ContactStepping::advance(Progress& progress) {
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

/// Stage 1: what the next motion may come near, and how long it may be. Sleeping parts that are driven wake.
ContactStepping::Motion ContactStepping::predict(Progress& progress) {
  State& state = progress.step.state;
  const double now = progress.now, left = progress.end - now, length = std::min(left, progress.longest);
  sleeping_.begin_motion(now, left, state);
  Motion motion;
  motion.predicted = look_ahead(state, now, length, progress.fall(), progress.soft_nearby);
  if (!meshes_.empty()) progress.method.expect_touch(motion.predicted.soft);
  if (!(motion.predicted.h > left / kMaxMotions)) fail_too_fast(progress);
  FreeMotion& free = motion.free;
  free.begin = now;
  free.h = motion.predicted.h >= left - progress.near ? left : motion.predicted.h;
  free.reach = progress.method.reach();
  free.slow = progress.slow;
  free.loose = progress.loose;
  if (!motion.predicted.empty) motion.resting = resting_.at_rest(state, now, free.loose);
  free.h = resting_.longest(free, motion.resting, dynamics_.model().body().gravity_at(now).norm());
  if (now != state.time() || free.h != state.h) set_step(state, now, free.h);
  progress.clock.lap(times_.finding);
  free.before = state;
  return motion;
}

void ContactStepping::fail_too_fast(const Progress& progress) const {
  const double h = progress.end - progress.begin;
  std::ostringstream message;
  message << "parts move so fast past each other that a step of " << h << " s would need more than "
          << kMaxMotions << " motions; use a smaller step";
  throw NumericalFailure(message.str(), progress.now);
}

/// Stage 3: the contacts at the end of the motion. Returns false, with the state of its start, if the motion
/// was too long or woke sleeping parts.
bool ContactStepping::detect(Motion& motion, Progress& progress) {
  State& state = progress.step.state;
  const FreeMotion& free = motion.free;
  auto repeat = [&](double longest) {
    progress.longest = longest;
    state = free.before;
    return false;
  };
  motion.travelled =
      finder_.neighbourhood_of(free.before, state, free.begin, free.h, progress.fall(), motion.predicted);
  if (!meshes_.empty())
    meshes_.approach(free.before, &state, free.begin, free.h, progress.fall(), motion.travelled);
  progress.soft_nearby = motion.travelled.soft && !motion.predicted.soft;
  if (progress.soft_nearby || motion.travelled.h < free.h - progress.near)
    return repeat(std::min(motion.travelled.h, free.h));
  progress.longest = std::max(progress.longest, 2 * free.h);
  if (motion.meets_nothing()) return true;
  const double longest = resting_.longest(free, motion.resting, state);
  if (longest < free.h - progress.near) return repeat(longest);
  motion.contacts = resting_.met(free, motion.resting, state);
  return !wake_met(motion.contacts, free, state);
}

/// Returns what a motion of at most `length` seconds from now on may come near. touch: whether parts that
/// deform locally are known to come near something.
ContactFinder::Neighbourhood ContactStepping::look_ahead(const State& state, double now, double length,
                                                         double fall, bool touch) {
  ContactFinder::Neighbourhood around = finder_.neighbourhood(state, now, length, fall);
  if (meshes_.empty()) return around;
  meshes_.approach(state, nullptr, now, length, fall, around);
  around.soft = around.soft || touch;
  return around;
}

/// Wakes sleeping parts that a contact touches, at the start of the motion. Returns whether there were any.
bool ContactStepping::wake_met(const std::vector<Contact>& contacts, const FreeMotion& motion, State& state) {
  if (!sleeping_.any()) return false;
  std::vector<Contact> of_meshes;
  meshes_.find(state, motion.end(), of_meshes);
  if (!sleeping_.is_met(contacts, state) && !sleeping_.is_met(of_meshes, state)) return false;
  state = motion.before;
  sleeping_.wake_met(contacts, state);
  sleeping_.wake_met(of_meshes, state);
  return true;
}

void ContactStepping::record_resting(const Motion& motion, bool to_event) {
  if (to_event && few_parts_)
    rested_.insert(rested_.end(), motion.resting.begin(), motion.resting.end());
  else
    meets_late_ = meets_late_ || !motion.resting.empty();
}

/// Returns the impacts, if they are so few that locating their time pays; otherwise none.
std::vector<Contact> ContactStepping::few_impacts(const Motion& motion) const {
  std::vector<Contact> impacts;
  if (!few_parts_) return impacts;
  const Pairs rest(motion.resting);
  for (const Contact& contact : motion.contacts) {
    if (rest.has(contact) || Pairs(impacts).has(contact)) continue;
    if (impacts.size() == kMaxLocatedPairs) return {};
    impacts.push_back(contact);
  }
  return impacts;
}

/// Stage 4: cuts the motion at its first impact, if the impact can be located, and strikes there. Returns
/// whether it did.
bool ContactStepping::locate_and_strike(Motion& motion, Progress& progress) {
  StepCounters& counters = progress.step.counters;
  const std::vector<Contact> impacts = few_impacts(motion);
  if (impacts.empty()) return false;
  if (progress.impacts == kMaxLocatedImpacts) {
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
  strike(motion, impacts, progress);
  sleeping_.wake_moved(progress.step.state);
  return true;
}

/// Applies the impulses of an impact at the end of the motion, which was cut there.
void ContactStepping::strike(const Motion& motion, const std::vector<Contact>& impacts, Progress& progress) {
  const FreeMotion& free = motion.free;
  const Pairs rest(motion.resting), struck(impacts);
  const double now = free.end();
  State& state = progress.step.state;
  StepContext step(dynamics_, state, progress.step.work, progress.step.counters, now, free.h);
  // Resting parts have fallen freely until now, as parts in flight have. Their contacts are resolved first,
  // with those of parts that have come down since.
  std::vector<Contact> lying = resting_.met(free, motion.resting, state);
  lying.erase(std::remove_if(lying.begin(), lying.end(),
                             [&](const Contact& c) { return c.since == 0 && !rest.has(c); }),
              lying.end());
  meshes_.find(state, now, lying);
  time_impacts(finder_, free, state, lying);
  progress.clock.lap(times_.finding);
  resolution_.resolve(step, {free.before, free.held(), free.h}, std::move(lying));
  progress.clock.lap(times_.resolution);
  std::vector<Contact> there = finder_.find(state, now, resting_.gap());
  there.erase(std::remove_if(there.begin(), there.end(),
                             [&](const Contact& c) {
                               return c.gap > resting_.gap(c) || (c.gap > kTouchingGap * resting_.gap(c) &&
                                                                  !rest.has(c) && !struck.has(c));
                             }),
              there.end());
  for (Contact& contact : there) {
    const double rebound = -contact.restitution * finder_.velocity(state, contact).dot(contact.normal);
    if (!rest.has(contact) && rebound > free.slow) contact.rebound = rebound;
  }
  progress.clock.lap(times_.finding);
  resolution_.resolve(step, {state, 0, 0}, std::move(there));
  progress.clock.lap(times_.resolution);
}

/// Stages 5 and 6: impulses at the contacts at the end of the motion, then the overlaps that are left are
/// separated.
void ContactStepping::resolve(Motion& motion, Progress& progress) {
  const FreeMotion& free = motion.free;
  std::vector<Contact>& contacts = motion.contacts;
  State& state = progress.step.state;
  progress.now = free.end();
  StepContext step(dynamics_, state, progress.step.work, progress.step.counters, progress.now, free.h);
  const StepResponses responses(progress.method, dynamics_.model(), step.work);
  meshes_.find(state, progress.now, contacts);
  time_impacts(finder_, free, state, contacts);
  // Parts that are stepped implicitly have one velocity in a step, by which all of their nodes move.
  if (progress.method.local_is_implicit())
    for (Contact& contact : contacts)
      if (contact.a.at_nodes() || contact.b.at_nodes()) contact.since = free.held();
  meets_late_ = meets_late_ || !contacts.empty();
  progress.clock.lap(times_.finding);
  resolution_.resolve(step, {free.before, free.held(), free.h}, contacts);
  resolution_.resolve_chain(step, std::move(contacts), free.slow);
  sleeping_.wake_moved(state);
  progress.clock.lap(times_.resolution);
}

}  // namespace pliant
