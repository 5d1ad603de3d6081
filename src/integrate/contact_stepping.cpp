#include <pliant/integrate/contact_stepping.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include <pliant/integrate/impact_timing.h>
#include <pliant/integrate/step_failure.h>
#include <pliant/math/index.h>

#include "contact_pairs.h"

namespace pliant {

namespace {

/// Impacts of this speed, in units of what gravity gives in a step, do not rebound.
constexpr double kSlowImpact = 1e-3;
/// Most pairs whose impacts in one step are told in time, which takes the step of all parts several times
/// again; and most moving parts of a body for which that is worth it.
constexpr std::size_t kMostPairs = 3;
constexpr std::ptrdiff_t kMostLocated = 8;
/// Most parts of a step, so that nothing passes through anything.
constexpr double kMostParts = 1e4;
constexpr int kMostEvents = 200;
/// Points of one contact at the start and the end of a step are nearer than this, in sizes.
constexpr double kSamePoint = 0.2;
/// Where an impact has been told in time, surfaces this near, as a share of what counts as resting, touch.
constexpr double kTouchAtImpact = 1e-6;

}  // namespace

ContactStepping::ContactStepping(const Dynamics& dynamics)
    : dynamics_(dynamics),
      finder_(dynamics.model()),
      meshes_(dynamics.model(), finder_.obstacles()),
      resting_(dynamics.model(), finder_),
      settling_(dynamics, finder_, meshes_, resting_, record_),
      sleeping_(dynamics, resting_, meshes_) {
  for (ContactRecord* record : {&record_, &record_before_})
    record->joint_impulses.setZero(dynamics.model().n_rows());
  few_parts_ = std::count_if(dynamics.model().parts().begin(), dynamics.model().parts().end(),
                             [](const PartModel& m) { return m.q0 >= 0; }) <= kMostLocated;
}

void ContactStepping::begin_step() {
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

bool ContactStepping::any_lasts() const {
  return std::any_of(record_.contacts.begin(), record_.contacts.end(),
                     [](const Contact& contact) { return contact.since > 0; });
}

double ContactStepping::step(Integrator& method, State& state, Workspace<double>& work,
                             StepCounters& counters, bool to_impact) {
  const double start = state.start, h = state.h, begin = state.time(), end = begin + h;
  double taken = h;
  const std::int64_t number = state.step;
  const double near = 8 * std::numeric_limits<double>::epsilon() * std::max(std::abs(end), h);
  const double slow = kSlowImpact * dynamics_.model().body().gravity_at(end).norm() * h;
  int events = 0;
  using Clock = std::chrono::steady_clock;
  Clock::time_point last = Clock::now();
  const auto lap = [&last](double& stage) {
    const Clock::time_point at_lap = Clock::now();
    stage += std::chrono::duration<double>(at_lap - last).count();
    last = at_lap;
  };
  double most = h;     // of a stage: in a longer one parts went further than was foreseen
  bool touch = false;  // likewise: what deforms locally came near something
  State before;
  for (double now = state.time(); now < end - near;) {
    sleeping_.begin_motion(now, end - now, state);
    const double whole = std::min(end - now, most), fall = method.local_is_implicit() ? 1 : method.reach();
    ContactFinder::Neighbourhood around = finder_.neighbourhood(state, now, whole, fall);
    if (!meshes_.empty()) {
      meshes_.approach(state, nullptr, now, whole, fall, around);
      around.soft = around.soft || touch;
      method.expect_touch(around.soft);
    }
    const double reach = method.reach();
    if (!(around.h > (end - now) / kMostParts)) {
      std::ostringstream message;
      message << "parts move so fast past each other that a step of " << h << " s would be " << kMostParts
              << " and more; a smaller step than " << h << " s may cure it";
      throw NumericalFailure(message.str(), now);
    }
    const double length = around.h >= end - now - near ? end - now : around.h;
    if (now != start + static_cast<double>(number) * h || length != h) set_step(state, now, length);
    lap(times_.finding);
    before = state;
    method.step(dynamics_, state, work, counters);
    sleeping_.restore(state);
    lap(times_.motion);
    if (!state.q.allFinite() || !state.v.allFinite()) break;
    ContactFinder::Neighbourhood went = finder_.neighbourhood_of(before, state, now, length, fall, around);
    if (!meshes_.empty()) meshes_.approach(before, &state, now, length, fall, went);
    lap(times_.finding);
    touch = went.soft && !around.soft;
    if (touch || went.h < length - near) {
      most = std::min(went.h, length);
      state = before;
      continue;
    }
    most = std::max(most, 2 * length);
    if (around.empty && went.empty) {
      now += length;
      continue;
    }
    const double after = now + length;
    const std::vector<Contact> resting = resting_.at_rest(before, now, slow);
    const Pairs rest(resting);
    // Those that meet at the end, and of those that rested on each other all that are near: rounding may have
    // parted them, or their free motion, in which nothing has held them yet.
    double near_by = resting.empty() ? 0 : resting_.gap();
    for (const Contact& contact : resting)
      near_by = std::max(
          near_by, resting_.gap() + reach * length * finder_.velocity(state, contact).dot(contact.normal));
    std::vector<Contact> contacts = finder_.find(state, after, near_by);
    contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                  [&](const Contact& c) {
                                    return c.gap > 0 && (!rest.has(c) ||
                                                         (c.gap > resting_.gap(c) &&
                                                          !resting_.rested(c, before, state, reach, slow)));
                                  }),
                   contacts.end());
    // Sleepers that are met wake at the start of the step.
    std::vector<Contact> of_meshes;
    if (sleeping_.any()) meshes_.find(state, after, of_meshes);
    if (sleeping_.is_met(contacts, state) || sleeping_.is_met(of_meshes, state)) {
      state = before;
      sleeping_.wake_met(contacts, state);
      sleeping_.wake_met(of_meshes, state);
      continue;
    }
    std::vector<Contact> impacts;
    for (Contact& contact : contacts) {
      const double size = dynamics_.model().parts()[at(contact.a.part)].part->size();
      if (rest.has(contact,
                   [&](const Contact& other) {
                     return contact.gap > 0 || (contact.x - other.x).norm() <= kSamePoint * size;
                   }) ||
          (rest.has(contact) && resting_.rested(contact, before, state, reach, slow)))
        contact.since = reach * length;
      if (impacts.size() <= kMostPairs && few_parts_ && !rest.has(contact) && !Pairs(impacts).has(contact))
        impacts.push_back(contact);
    }
    lap(times_.finding);
    if (!impacts.empty() && impacts.size() <= kMostPairs && events < kMostEvents) {
      const std::optional<double> tau =
          locate_impact(dynamics_, finder_, method, before, now, length, impacts, state, work, counters);
      sleeping_.restore(state);
      lap(times_.motion);
      if (tau) {
        ++events;
        ++counters.impacts;
        now += *tau;
        const StepResponses responses(method, dynamics_.model(), work);
        // What rests has fallen freely until then as what is in flight has: it is held first.
        std::vector<Contact> lying = finder_.find(state, now, resting_.gap());
        lying.erase(std::remove_if(lying.begin(), lying.end(),
                                   [&](const Contact& c) { return c.gap > resting_.gap(c) || !rest.has(c); }),
                    lying.end());
        for (Contact& contact : lying) contact.since = reach * *tau;
        meshes_.find(state, now, lying);
        time_impacts(finder_, before, state, reach, *tau, slow, lying);
        lap(times_.finding);
        settling_.settle(before, reach * *tau, *tau, state, now, std::move(lying), work, counters);
        lap(times_.settling);
        std::vector<Contact> there = finder_.find(state, now, resting_.gap());
        there.erase(std::remove_if(there.begin(), there.end(),
                                   [&](const Contact& c) {
                                     return c.gap > resting_.gap(c) ||
                                            (c.gap > kTouchAtImpact * resting_.gap(c) && !rest.has(c) &&
                                             !Pairs(impacts).has(c));
                                   }),
                    there.end());
        for (Contact& contact : there) {
          const double rebound = -contact.restitution * finder_.velocity(state, contact).dot(contact.normal);
          if (!rest.has(contact) && rebound > slow) contact.rebound = rebound;
        }
        lap(times_.finding);
        settling_.settle(state, 0, 0, state, now, std::move(there), work, counters);
        lap(times_.settling);
        sleeping_.wake_moved(state);
        if (!to_impact || !(now > begin)) continue;
        taken = now - begin;
        break;
      }
    }
    const StepResponses responses(method, dynamics_.model(), work);
    meshes_.find(state, after, contacts);
    time_impacts(finder_, before, state, reach, length, slow, contacts);
    // What is stepped implicitly has but one velocity in a step, by which all of it moves.
    if (method.local_is_implicit())
      for (Contact& contact : contacts)
        if (contact.a.at_nodes() || contact.b.at_nodes()) contact.since = reach * length;
    lap(times_.finding);
    settling_.settle(before, reach * length, length, state, after, contacts, work, counters);
    settling_.settle_chain(std::move(contacts), length, slow, state, after, work, counters);
    sleeping_.wake_moved(state);
    lap(times_.settling);
    now = after;
  }
  state.start = start;
  state.step = number;
  state.h = h;
  sleeping_.fall_asleep(record_.contacts, begin, taken, state);
  return taken;
}

}  // namespace pliant
