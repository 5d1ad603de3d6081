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

#include "contact_pairs.h"

namespace pliant {

namespace {

/// Impacts of this speed, in units of what gravity gives in a step, do not rebound.
constexpr double kSlowImpact = 1e-3;
/// What impulses left of the laws of contact moves what rests in the next step by this many times as much, at
/// most as gravity would: that much counts as resting.
constexpr double kLoose = 8;
/// Most pairs whose impacts in one step are told in time, which takes the step of all parts several times
/// again; and most moving parts of a body for which that is worth it.
constexpr std::size_t kMostPairs = 3;
constexpr std::ptrdiff_t kMostLocated = 8;
/// Most parts of a step, so that nothing passes through anything.
constexpr double kMostParts = 1e4;
constexpr int kMostEvents = 200;
/// Where an impact has been told in time, surfaces this near, as a share of what counts as resting, touch.
constexpr double kTouchAtImpact = 1e-6;

/// How fast what rests may move, m/s, as impulses left so much of the laws of contact: a power of two, so
/// that what was found near each other is mostly still good.
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
                             [](const PartModel& m) { return m.q0 >= 0; }) <= kMostLocated;
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

/// Tells how long stages take, one after the other.
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

/// What a motion of `whole` seconds from now on comes near to; touch: what deforms locally is known to.
ContactFinder::Neighbourhood ContactStepping::look_ahead(const State& state, double now, double whole,
                                                         double fall, bool touch) {
  ContactFinder::Neighbourhood around = finder_.neighbourhood(state, now, whole, fall);
  if (meshes_.empty()) return around;
  meshes_.approach(state, nullptr, now, whole, fall, around);
  around.soft = around.soft || touch;
  return around;
}

/// Sleepers that what was met touches wake; whether there are any.
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

/// Impacts that are so few that their time is worth finding; otherwise none.
std::vector<Contact> ContactStepping::few_impacts(const std::vector<Contact>& contacts,
                                                  const std::vector<Contact>& resting) const {
  std::vector<Contact> impacts;
  if (!few_parts_) return impacts;
  const Pairs rest(resting);
  for (const Contact& contact : contacts) {
    if (rest.has(contact) || Pairs(impacts).has(contact)) continue;
    if (impacts.size() == kMostPairs) return {};
    impacts.push_back(contact);
  }
  return impacts;
}

/// Impulses at an impact that was told in time, the end of a motion.
void ContactStepping::strike(const FreeMotion& motion, const std::vector<Contact>& resting,
                             const std::vector<Contact>& impacts, State& state, Workspace<double>& work,
                             StepCounters& counters, StageClock& clock) {
  const Pairs rest(resting), struck(impacts);
  const double now = motion.end();
  // What rests has fallen freely until then as what is in flight has: it is held first, with what else of it
  // has come down.
  std::vector<Contact> lying = resting_.met(motion, resting, state);
  lying.erase(std::remove_if(lying.begin(), lying.end(),
                             [&](const Contact& c) { return c.since == 0 && !rest.has(c); }),
              lying.end());
  meshes_.find(state, now, lying);
  time_impacts(finder_, motion, state, lying);
  clock.lap(times_.finding);
  resolution_.resolve(motion.before, motion.held(), motion.h, state, now, std::move(lying), work, counters);
  clock.lap(times_.resolution);
  std::vector<Contact> there = finder_.find(state, now, resting_.gap());
  there.erase(std::remove_if(there.begin(), there.end(),
                             [&](const Contact& c) {
                               return c.gap > resting_.gap(c) || (c.gap > kTouchAtImpact * resting_.gap(c) &&
                                                                  !rest.has(c) && !struck.has(c));
                             }),
              there.end());
  for (Contact& contact : there) {
    const double rebound = -contact.restitution * finder_.velocity(state, contact).dot(contact.normal);
    if (!rest.has(contact) && rebound > motion.slow) contact.rebound = rebound;
  }
  clock.lap(times_.finding);
  resolution_.resolve(state, 0, 0, state, now, std::move(there), work, counters);
  clock.lap(times_.resolution);
}

double ContactStepping::step(Integrator& method, State& state, Workspace<double>& work,
                             StepCounters& counters, bool to_event) {
  const double start = state.start, h = state.h, begin = state.time(), end = begin + h;
  double taken = h;
  const std::int64_t number = state.step;
  const double near = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(end), h);
  int events = 0;
  StageClock clock;
  double most = h;     // of a motion: in a longer one parts went further than was foreseen
  bool touch = false;  // likewise: what deforms locally came near something
  FreeMotion motion;
  const double falls = dynamics_.model().body().gravity_at(end).norm() * h,
               left = loose_speed(state.contact_residual, falls);
  state.contact_residual = 0;
  resolution_.begin_step(state);
  motion.slow = kSlowImpact * falls;
  motion.loose = std::max(motion.slow, left);
  resting_.loosen(left * h);
  for (double now = begin; now < end - near;) {
    sleeping_.begin_motion(now, end - now, state);
    const double whole = std::min(end - now, most), fall = method.local_is_implicit() ? 1 : method.reach();
    const ContactFinder::Neighbourhood around = look_ahead(state, now, whole, fall, touch);
    if (!meshes_.empty()) method.expect_touch(around.soft);
    if (!(around.h > (end - now) / kMostParts)) {
      std::ostringstream message;
      message << "parts move so fast past each other that a step of " << h << " s would be " << kMostParts
              << " and more; a smaller step than " << h << " s may cure it";
      throw NumericalFailure(message.str(), now);
    }
    motion.begin = now;
    motion.h = around.h >= end - now - near ? end - now : around.h;
    motion.reach = method.reach();
    std::vector<Contact> resting;
    if (!around.empty) resting = resting_.at_rest(state, now, motion.loose);
    motion.h = resting_.longest(motion, resting, dynamics_.model().body().gravity_at(now).norm());
    if (now != start + static_cast<double>(number) * h || motion.h != h) set_step(state, now, motion.h);
    clock.lap(times_.finding);
    motion.before = state;
    method.step(dynamics_, state, work, counters);
    sleeping_.restore(state);
    clock.lap(times_.motion);
    if (!state.q.allFinite() || !state.v.allFinite()) break;
    ContactFinder::Neighbourhood travelled =
        finder_.neighbourhood_of(motion.before, state, now, motion.h, fall, around);
    if (!meshes_.empty()) meshes_.approach(motion.before, &state, now, motion.h, fall, travelled);
    clock.lap(times_.finding);
    touch = travelled.soft && !around.soft;
    if (touch || travelled.h < motion.h - near) {
      most = std::min(travelled.h, motion.h);
      state = motion.before;
      continue;
    }
    most = std::max(most, 2 * motion.h);
    if (around.empty && travelled.empty) {
      now = motion.end();
      continue;
    }
    if (const double longest = resting_.longest(motion, resting, state); longest < motion.h - near) {
      most = longest;
      state = motion.before;
      continue;
    }
    std::vector<Contact> contacts = resting_.met(motion, resting, state);
    if (wake_met(contacts, motion, state)) continue;
    if (to_event && few_parts_)
      rested_.insert(rested_.end(), resting.begin(), resting.end());
    else
      meets_late_ = meets_late_ || !resting.empty();
    clock.lap(times_.finding);
    std::vector<Contact> impacts = few_impacts(contacts, resting);
    if (!impacts.empty() && events == kMostEvents) {
      ++counters.contact_cutoffs;
      impacts.clear();
    }
    if (!impacts.empty()) {
      const std::optional<double> tau = locate_impact(dynamics_, finder_, method, motion.before, now,
                                                      motion.h, impacts, state, work, counters);
      sleeping_.restore(state);
      clock.lap(times_.motion);
      if (tau) {
        ++events;
        ++counters.impacts;
        motion.h = *tau;
        now = motion.end();
        const StepResponses responses(method, dynamics_.model(), work);
        strike(motion, resting, impacts, state, work, counters, clock);
        sleeping_.wake_moved(state);
        if (!to_event || !(now > begin)) continue;
        taken = now - begin;
        break;
      }
    }
    now = motion.end();
    const StepResponses responses(method, dynamics_.model(), work);
    meshes_.find(state, now, contacts);
    time_impacts(finder_, motion, state, contacts);
    // What is stepped implicitly has but one velocity in a step, by which all of it moves.
    if (method.local_is_implicit())
      for (Contact& contact : contacts)
        if (contact.a.at_nodes() || contact.b.at_nodes()) contact.since = motion.held();
    meets_late_ = meets_late_ || !contacts.empty();
    clock.lap(times_.finding);
    resolution_.resolve(motion.before, motion.held(), motion.h, state, now, contacts, work, counters);
    resolution_.resolve_chain(std::move(contacts), motion.h, motion.slow, state, now, work, counters);
    sleeping_.wake_moved(state);
    clock.lap(times_.resolution);
    if (to_event && now < end - near && few_parts_ && any_resting()) {
      taken = now - begin;
      break;
    }
  }
  state.start = start;
  state.step = number;
  state.h = h;
  resolution_.end_step(taken, state);
  sleeping_.fall_asleep(record_.contacts, begin, taken, state);
  return taken;
}

}  // namespace pliant
