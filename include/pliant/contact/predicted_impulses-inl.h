// Function bodies of predicted_impulses.h.
#pragma once

#include <pliant/contact/predicted_impulses.h>

#include <algorithm>
#include <limits>
#include <utility>

#include <pliant/body/speed_scale.h>
#include <pliant/contact/connected_bodies.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/load_work.h>
#include <pliant/contact/touched_parts.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/project/project.h>

namespace pliant {

namespace predicted_impulses {

/// Impulses are not predicted if they would move the sides of a contact by more than this share of the size
/// of the smaller body in the motion, or by more than ContactFinder::max_resolved_depth.
inline constexpr double kMaxLift = 0.05;
/// Impulses are predicted only at contacts with at most this overlap, in sizes of the smaller body.
inline constexpr double kMaxOverlap = 1e-6;

inline bool is_unpredicted(const Contact& contact) {
  return contact.predicted.isZero(0);
}

/// Returns whether the motion of a part, or of a part of its island, has a bound besides contacts: a
/// parameter is at a limit, a string is taut, or a joint follows a prescribed path. A predicted impulse could
/// move the part beyond a one-sided bound. The works of predicted impulses do not include the work of a
/// driven joint.
inline bool is_bounded(const Model& model, const State& state, int part) {
  const int island = model.parts()[at(part)].island;
  auto at_limit = [&](int i) {
    const PartModel& m = model.parts()[at(i)];
    for (int k = 0; k < m.n_s; ++k)
      if (near_limit(m, k, state) != 0) return true;
    return false;
  };
  if (island < 0) return at_limit(part);
  const Island& all = model.islands()[at(island)];
  return are_driven(model, {part}) || std::any_of(all.parts.begin(), all.parts.end(), at_limit) ||
         std::any_of(all.strings.begin(), all.strings.end(),
                     [&](int j) { return state.joints[at(j)] == JointMode::closed; });
}

/// Returns whether a side of a contact moves faster than motion.max_resting_speed. Bodies at rest need no
/// prediction, because the whole impulse at the end of the motion is then exact.
inline bool moves(const Model& model, const State& state, const FreeMotion& motion, const Contact& contact) {
  for (const int part : {contact.a.part, contact.b.part}) {
    if (part < 0 || model.parts()[at(part)].q0 < 0) continue;
    const PartModel& m = model.parts()[at(part)];
    if (largest_speed(m, state.v.segment(m.v0, 6 + m.n_s)) > motion.max_resting_speed) return true;
  }
  return false;
}

/// Adds the works of the predicted impulse of a contact to a state. mean: the mean of the velocities at the
/// contact before and after all predicted impulses, m/s.
inline void add_work(const Contact& contact, const Vec3<double>& mean, State& state) {
  const Vec3<double>&p = contact.predicted, &n = contact.normal;
  const double along = p.dot(n) * mean.dot(n);
  state.work[static_cast<int>(Work::contact)] += along + p.dot(contact.prescribed_velocity);
  state.work[static_cast<int>(Work::friction)] += p.dot(mean) - along;
}

/// Moves contact points from the start of a motion to its end: each point moves with the part of side a.
/// state: the state at the end.
inline void follow_parts(const Model& model, const FreeMotion& motion, const State& state,
                         std::vector<Contact>& contacts) {
  for (Contact& contact : contacts) {
    const int part = contact.a.part;
    const Vec3<double> r = model.orientation(motion.before, part, motion.begin).conjugate() *
                           (contact.x - model.position(motion.before, part, motion.begin));
    contact.x = model.position(state, part, motion.end()) + model.orientation(state, part, motion.end()) * r;
  }
}

/// Bodies that resting contacts connect, and whether impulses at them are predicted.
class PredictedBodies {
 public:
  PredictedBodies(const Model& model, const State& state, const std::vector<Contact>& resting)
      : connected_(model), excluded_(model.parts().size(), false) {
    for (const CachedContact& cached : state.contact_cache)
      connected_.connect(cached.between[0], cached.between[1]);
    for (const Contact& contact : resting) connected_.connect(contact.a.part, contact.b.part);
  }

  /// Excludes the bodies that contacts connect with a pair of parts.
  void exclude(int a, int b) {
    if (const int set = connected_.set_of(a, b); set >= 0) excluded_[at(set)] = true;
  }
  /// Returns the number of the set of bodies of a contact; -1: its impulse is not predicted.
  int set_of(const Contact& contact) {
    const int set = connected_.set_of(contact.a.part, contact.b.part);
    return set >= 0 && !excluded_[at(set)] ? set : -1;
  }

 private:
  ConnectedBodies connected_;
  std::vector<bool> excluded_;  // of each set
};

/// Excludes the body of each part at a contact if the part sleeps or is bounded (is_bounded()).
inline void exclude_bounded(const Model& model, const State& state, const std::vector<Contact>& resting,
                            PredictedBodies& bodies) {
  std::vector<bool> examined(model.islands().size(), false);
  for (const Contact& contact : resting)
    for (const int part : {contact.a.part, contact.b.part}) {
      if (part < 0 || model.parts()[at(part)].q0 < 0) continue;
      const int island = model.parts()[at(part)].island;
      if (island >= 0 && examined[at(island)]) continue;
      if (island >= 0) examined[at(island)] = true;
      if (sleeps(state, part) || is_bounded(model, state, part)) bodies.exclude(part, -1);
    }
}

/// Sets the predicted impulses of the resting contacts: motion.force_time() times their forces in the last
/// step.
inline void predict(const Prediction& prediction, const FreeMotion& motion, PredictedBodies& bodies,
                    std::vector<Contact>& resting) {
  const State& state = prediction.step.state;
  const Model& model = prediction.step.model();
  const std::vector<CachedContact>& cache = state.contact_cache;
  const std::vector<int> numbers = prediction.resolution.cached_numbers(state, motion.begin, resting);
  std::vector<bool> found(cache.size(), false);
  for (std::size_t k = 0; k < resting.size(); ++k) {
    const Contact& contact = resting[k];
    if (numbers[k] >= 0) found[at(numbers[k])] = true;
    const bool is_second =
        k > 0 && key_of(resting[k - 1]) == key_of(contact);  // contacts of a pair are adjacent
    if (is_second || !prediction.finder.is_smooth(contact) ||
        contact.gap < -kMaxOverlap * smaller_size(model, contact))
      bodies.exclude(contact.a.part, contact.b.part);
  }
  for (std::size_t i = 0; i < cache.size(); ++i)
    if (!cache[i].lasting || !found[i]) bodies.exclude(cache[i].between[0], cache[i].between[1]);
  exclude_bounded(model, state, resting, bodies);
  std::vector<bool> moving(model.parts().size(), false);  // of each set
  for (const Contact& contact : resting)
    if (const int set = bodies.set_of(contact); set >= 0 && moves(model, state, motion, contact))
      moving[at(set)] = true;
  for (std::size_t k = 0; k < resting.size(); ++k)
    if (const int set = bodies.set_of(resting[k]); numbers[k] >= 0 && set >= 0 && moving[at(set)])
      resting[k].predicted = motion.force_time() * cache[at(numbers[k])].force;
}

/// Sets the distances (Contact::lift) by which predicted impulses open contacts in a motion of h seconds. If
/// a predicted impulse moves the sides of a contact by more than kMaxLift allows, removes the predicted
/// impulses of its bodies. Returns whether any were removed. changes: changes of the velocities at the
/// contacts by all predicted impulses, m/s.
inline bool remove_large(const Prediction& prediction, double h, const ContactProblem& problem,
                         const std::vector<Vec3<double>>& changes, PredictedBodies& bodies,
                         std::vector<Contact>& contacts) {
  bool any = false;
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    Contact& contact = contacts[k];
    contact.lift = h * std::max(0.0, problem.own_speed(static_cast<int>(k)));
    const double max_lift = std::min(kMaxLift * smaller_size(problem.model(), contact),
                                     prediction.finder.max_resolved_depth(contact));
    if (std::max(h * changes[k].norm(), contact.lift) <= max_lift) continue;
    bodies.exclude(contact.a.part, contact.b.part);
    any = true;
  }
  for (Contact& contact : contacts) {
    if (!any || bodies.set_of(contact) >= 0) continue;
    contact.predicted.setZero();
    contact.lift = 0;
  }
  return any;
}

}  // namespace predicted_impulses

PLIANT_INLINE void apply_predicted_impulses(const Prediction& prediction, FreeMotion& motion,
                                            std::vector<Contact>& resting) {
  using predicted_impulses::is_unpredicted;
  StepContext& step = prediction.step;
  State& state = step.state;
  const Model& model = step.model();
  if (state.contact_cache.empty() ||
      std::none_of(resting.begin(), resting.end(), [&](const Contact& contact) {
        return predicted_impulses::moves(model, state, motion, contact);
      }))
    return;
  predicted_impulses::PredictedBodies bodies(model, state, resting);
  predicted_impulses::predict(prediction, motion, bodies, resting);
  std::stable_partition(resting.begin(), resting.end(), is_unpredicted);
  for (;;) {
    const auto first = std::partition_point(resting.begin(), resting.end(), is_unpredicted);
    std::vector<Contact> predicted(first, resting.end());
    if (predicted.empty()) return;
    evaluate_touched(step.dynamics, state, motion.begin, predicted, step.work);
    ContactProblem problem(model, state, step.work, predicted);
    BeforePrediction before{state.v, state.work};
    const std::vector<Vec3<double>> u = problem.velocities(state);
    problem.apply_predicted();
    apply_velocities(problem, model, step.work, state);
    std::vector<Vec3<double>> changes = problem.velocities(state);
    for (std::size_t k = 0; k < changes.size(); ++k) changes[k] -= u[k];
    const bool repeat =
        predicted_impulses::remove_large(prediction, motion.h, problem, changes, bodies, predicted);
    std::copy(predicted.begin(), predicted.end(), first);
    if (repeat) {
      state.v = before.v;
      std::stable_partition(first, resting.end(), is_unpredicted);
      continue;
    }
    for (std::size_t k = 0; k < predicted.size(); ++k)
      predicted_impulses::add_work(predicted[k], u[k] + 0.5 * changes[k], state);
    motion.unpredicted = std::move(before);
    return;
  }
}

PLIANT_INLINE std::vector<Contact> assign_predicted_impulses(std::vector<Contact>& resting,
                                                             std::vector<Contact>& contacts) {
  for (Contact& contact : contacts) {  // contacts of add_followed() are copies with the values at the start
    contact.predicted.setZero();
    contact.lift = 0;
  }
  std::vector<Contact> lost;
  for (Contact& from : resting) {
    if (predicted_impulses::is_unpredicted(from)) continue;
    const auto [first, last] =
        std::equal_range(contacts.begin(), contacts.end(), from, ContactFinder::precedes);
    const auto distance = [&](const Contact& to) {
      return to.since > 0 ? (to.x - from.x).norm() : std::numeric_limits<double>::infinity();
    };
    const auto to = std::min_element(
        first, last, [&](const Contact& a, const Contact& b) { return distance(a) < distance(b); });
    if (to != last && to->since > 0) {
      to->predicted = from.predicted;
      to->lift = from.lift;
      continue;
    }
    lost.push_back(from);
    from.predicted.setZero();
    from.lift = 0;
  }
  return lost;
}

PLIANT_INLINE void take_back_predicted_impulses(const Prediction& prediction, const FreeMotion& motion,
                                                std::vector<Contact> lost) {
  StepContext step(prediction.step.dynamics, prediction.step.state, prediction.step.work,
                   prediction.step.counters, motion.end(), motion.h);
  State& state = step.state;
  const Model& model = step.model();
  const std::vector<int> parts = parts_touched(model, lost);
  Workspace<double> scratch;
  const auto balance = [&] {
    return step.dynamics.energy(step.t, state.q, state.v, parts, scratch) - state.work.sum();
  };
  const double balance_before = balance();
  predicted_impulses::follow_parts(model, motion, state, lost);
  evaluate_touched(step.dynamics, state, step.t, lost, step.work);
  ContactProblem problem(model, state, step.work, lost);
  LoadWork loads(step.dynamics, state);
  problem.take_back_predicted(motion.h);
  apply_solution(problem, model, step.work, state);
  prediction.resolution.reconcile(step, parts);
  project_limits(step);
  state.work[static_cast<int>(Work::forces)] += loads.work_until(step.t, state);
  state.work[static_cast<int>(Work::contact)] += balance() - balance_before;
}

}  // namespace pliant
