// Function bodies of contact_resolution.h: the contact cache, one resolution with its work, and chains of
// impacts (impulses that push bodies into others). contact_separation-inl.h has the separation of overlaps.
#pragma once

#include <pliant/contact/contact_resolution.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <utility>

#include <pliant/body/advance.h>
#include <pliant/body/speed_scale.h>
#include <pliant/contact/connected_bodies.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/damping_work.h>
#include <pliant/contact/load_work.h>
#include <pliant/contact/touched_parts.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/project/project.h>

namespace pliant {

namespace contact_resolution {

/// Largest number of resolutions in one call of resolve_chain().
inline constexpr int kMaxChainLinks = 4;
/// Two contacts of a pair, of different resolutions or steps, are the same if their contact points are nearer
/// than this share of the size of the smaller body.
inline constexpr double kSameContact = 0.05;
/// A motion is a whole step if it is shorter than the step by at most this share.
inline constexpr double kRounding = 1e-9;
/// Largest number of warm-started steps in a row.
inline constexpr int kMaxWarmStartAge = 10;
/// Returns a state in which the impulses of a solved problem have acted for `time` seconds at all contacts.
/// state: the state before the impulses. The displacements of the problem become `time` times the changes of
/// velocity.
inline State displaced_evenly(ContactProblem& problem, const Model& model, const Workspace<double>& work,
                              double time, State state) {
  problem.bound_shifts(time, 0);
  apply_solution(problem, model, work, state);
  return state;
}

/// Returns the parts of a list whose velocities do not jump, because no contact of the part, or of its island
/// (parts that joints connect), rebounds.
inline std::vector<int> without_rebound(const Model& model, const std::vector<Contact>& contacts,
                                        std::vector<int> parts) {
  std::vector<Contact> rebounding;
  std::copy_if(contacts.begin(), contacts.end(), std::back_inserter(rebounding),
               [](const Contact& contact) { return contact.rebound > 0; });
  if (rebounding.empty()) return parts;
  const std::vector<int> jumping = parts_touched(model, rebounding);
  parts.erase(
      std::remove_if(parts.begin(), parts.end(),
                     [&](int part) { return std::binary_search(jumping.begin(), jumping.end(), part); }),
      parts.end());
  return parts;
}

/// Returns the index in [first, last) of the position that is nearest to x, among the positions nearer than
/// `within` (m) for which is_taken is false; `last` if there is none. position, is_taken: functions of the
/// index.
template <class Position, class IsTaken>
std::size_t nearest(std::size_t first, std::size_t last, const Vec3<double>& x, double within,
                    Position&& position, IsTaken&& is_taken) {
  std::size_t found = last;
  for (std::size_t i = first; i < last; ++i) {
    const double distance = (position(i) - x).norm();
    if (!(distance < within) || is_taken(i)) continue;
    within = distance;
    found = i;
  }
  return found;
}

}  // namespace contact_resolution

PLIANT_INLINE void ContactRecord::clear() {
  contacts.clear();
  impulses.clear();
  sliding.clear();
  joint_impulses.setZero();
  time.clear();
  overlap = 0;
  worst_residual = worst_overlap = {};
}

PLIANT_INLINE ContactResolution::ContactResolution(const Dynamics& dynamics, const ContactFinder& finder,
                                                   MeshFinder& meshes, RestingContacts& resting,
                                                   ContactRecord& record)
    : dynamics_(dynamics), finder_(finder), meshes_(meshes), resting_(resting), record_(record) {}

PLIANT_INLINE void ContactResolution::reconcile(StepContext& step, const std::vector<int>& parts) const {
  project_frames(step, parts);
  project_joints(step);
}

/// Returns the distance (m) by which the rotation of a part moves a material point at x away from the tangent
/// of its path in h seconds. Because of this distance the point may enter another body, although its velocity
/// at the end of the step points away from that body.
PLIANT_INLINE double ContactResolution::departure_from_tangent(const ContactSide& side, const Vec3<double>& x,
                                                               const State& state, double h) const {
  if (side.part < 0 || side.at_nodes()) return 0;
  const PartModel& m = dynamics_.model().parts()[at(side.part)];
  if (m.q0 < 0) return 0;
  const double turn = h * state.v.segment<3>(m.v0 + 3).norm();
  return 0.5 * turn * turn * (x - state.q.segment<3>(m.q0)).norm();
}

/// Returns the contact point in the frame of part a, m. In this frame the contact point of a resting contact
/// stays the same while the bodies move.
PLIANT_INLINE Vec3<double> ContactResolution::local_position(const Contact& contact, const State& state,
                                                             double t) const {
  const Model& model = dynamics_.model();
  const int part = contact.a.part;
  return model.orientation(state, part, t).conjugate() * (contact.x - model.position(state, part, t));
}

/// Returns the distance (m) within which two contacts of a pair are the same contact.
PLIANT_INLINE double ContactResolution::match_distance(const Contact& contact) const {
  return contact_resolution::kSameContact * smaller_size(dynamics_.model(), contact);
}

PLIANT_INLINE void ContactResolution::begin_step(const State& state, bool predicts) {
  predicts_ = predicts;
  step_length_ = state.h;
  resolved_.clear();
  travel_.clear();
  resolutions_ = 0;
  cold_start_ =
      state.contact_cache.empty() || state.contact_cache_age >= contact_resolution::kMaxWarmStartAge;
}

PLIANT_INLINE std::vector<int> ContactResolution::cached_numbers(const State& state, double t,
                                                                 const std::vector<Contact>& contacts) const {
  const std::vector<CachedContact>& cache = state.contact_cache;
  std::vector<int> numbers(contacts.size(), -1);
  std::vector<char> taken(cache.size(), 0);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const auto [first, last] = std::equal_range(cache.begin(), cache.end(), contacts[k], ByPair{});
    if (first == last) continue;
    const auto end = static_cast<std::size_t>(last - cache.begin());
    const std::size_t found = contact_resolution::nearest(
        static_cast<std::size_t>(first - cache.begin()), end, local_position(contacts[k], state, t),
        match_distance(contacts[k]), [&](std::size_t i) { return cache[i].x; },
        [&](std::size_t i) { return taken[i] != 0; });
    if (found == end) continue;
    taken[found] = 1;
    numbers[k] = static_cast<int>(found);
  }
  return numbers;
}

PLIANT_INLINE void ContactResolution::warm_start(const State& state, double t, double h,
                                                 const std::vector<Contact>& contacts,
                                                 ContactProblem& problem) const {
  if (cold_start_) return;
  const std::vector<int> numbers = cached_numbers(state, t, contacts);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (numbers[k] >= 0)
      problem.warm_start_at(static_cast<int>(k), h * state.contact_cache[at(numbers[k])].force);
}

/// Returns for each contact whether its force lasts: the contact itself, and all contacts of bodies that
/// contacts connect with it, rest during the whole motion.
PLIANT_INLINE std::vector<bool> ContactResolution::lasting(const ResolvedMotion& motion,
                                                           const std::vector<Contact>& contacts) const {
  const Model& model = dynamics_.model();
  ConnectedBodies connected(model);
  for (const Contact& contact : contacts) connected.connect(contact.a.part, contact.b.part);
  auto set_of = [&](const Contact& contact) { return connected.set_of(contact.a.part, contact.b.part); };
  std::vector<bool> changes(model.parts().size(), false), lasts;
  for (const Contact& contact : contacts)
    if (const int set = set_of(contact); set >= 0 && contact.since != motion.force_time)
      changes[at(set)] = true;
  for (const Contact& contact : contacts) {
    const int set = set_of(contact);
    lasts.push_back(set >= 0 && !changes[at(set)]);
  }
  return lasts;
}

/// Records the impulses of one resolution, for the contact cache. Zero impulses are not recorded. Impulses
/// that cannot be a start value (may_warm_start) are recorded only if impulses are predicted.
PLIANT_INLINE void ContactResolution::record_resolved(const State& state, double t,
                                                      const ResolvedMotion& motion,
                                                      const std::vector<Contact>& contacts,
                                                      const ContactProblem& problem,
                                                      const std::vector<Vec3<double>>& impulses) {
  std::vector<bool> lasts;
  const bool whole_step = motion.h >= (1 - contact_resolution::kRounding) * step_length_;
  if (predicts_ && whole_step) lasts = lasting(motion, contacts);
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if ((predicts_ || problem.may_warm_start(static_cast<int>(k))) && !impulses[k].isZero(0))
      resolved_.push_back({{key_of(contacts[k]), local_position(contacts[k], state, t), impulses[k],
                            predicts_ && whole_step && lasts[k]},
                           match_distance(contacts[k]),
                           resolutions_});
  ++resolutions_;
}

PLIANT_INLINE void ContactResolution::end_step(double h, State& state) const {
  std::vector<Resolved> sorted = resolved_, merged;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Resolved& a, const Resolved& b) { return ByPair{}(a.cached, b.cached); });
  std::size_t first = 0;  // first entry of the pair in `merged`
  for (const Resolved& next : sorted) {
    if (merged.empty() || merged.back().cached.between != next.cached.between) first = merged.size();
    // The nearest contact of an earlier resolution is the same contact.
    const std::size_t same = contact_resolution::nearest(
        first, merged.size(), next.cached.x, next.match_distance,
        [&](std::size_t i) { return merged[i].cached.x; },
        [&](std::size_t i) { return merged[i].resolution == next.resolution; });
    if (same == merged.size()) {
      merged.push_back(next);
      continue;
    }
    merged[same].cached.force += next.cached.force;
    merged[same].cached.lasting = merged[same].cached.lasting && next.cached.lasting;
    merged[same].resolution = next.resolution;
  }
  state.contact_cache.clear();
  for (const Resolved& resolved : merged)
    if (const Vec3<double> force = resolved.cached.force / h; force.allFinite())
      state.contact_cache.push_back(
          {resolved.cached.between, resolved.cached.x, force, resolved.cached.lasting});
  state.contact_cache_age = cold_start_ || state.contact_cache.empty() ? 0 : state.contact_cache_age + 1;
}

PLIANT_INLINE void ContactResolution::resolve(StepContext& step, const ResolvedMotion& motion,
                                              const std::vector<Contact>& contacts) {
  fully_separated_.clear();
  if (contacts.empty()) return;
  resolve_once(step, motion, contacts, motion.h > 0);
}

/// Increases the travel of each part to at least its travel towards the bodies that it meets in a motion of h
/// seconds.
PLIANT_INLINE void ContactResolution::measure_travel(const State& state, double h,
                                                     const std::vector<Contact>& contacts) {
  travel_.resize(dynamics_.model().parts().size(), 0);
  for (const Contact& contact : contacts) {
    const double opening = finder_.velocity(state, contact).dot(contact.normal);
    extend_travel(contact, h * std::max(0.0, -opening) +
                               departure_from_tangent(contact.a, contact.x, state, h) +
                               departure_from_tangent(contact.b, contact.x, state, h));
  }
}

/// Computes the impulses and limits the displacements that they cause. Adds their work to the state, and the
/// reactions of joints to the record. Updates the largest residual in the state and in the counters. To
/// second order, the work of an impulse is that of a constant force during the motion. The impulses are also
/// recorded for the contact cache, unless motion.h is zero. warm: whether the search for the impulses starts
/// from the contact cache.
PLIANT_INLINE ContactSolution ContactResolution::solve(StepContext& step, const ResolvedMotion& motion,
                                                       const std::vector<Contact>& contacts, bool warm,
                                                       ContactProblem& problem) {
  State& state = step.state;
  const std::vector<Vec3<double>> u_start = problem.velocities(motion.before);
  std::vector<Vec3<double>> u_free;
  if (problem.has_predicted()) u_free = problem.velocities(state);
  if (warm) warm_start(state, step.t, motion.h, contacts, problem);
  ContactSolution solution = problem.solve(motion.force_time);
  if (motion.h > 0) record_resolved(state, step.t, motion, contacts, problem, solution.impulse);
  step.counters.contact_sweeps += solution.sweeps;
  step.counters.contact_fallbacks += solution.fallbacks;
  step.counters.contact_residual = std::max(step.counters.contact_residual, solution.residual);
  state.contact_residual = std::max(state.contact_residual, solution.residual);
  record_.worst_residual.keep_worse({solution.worst_residual, solution.worst_accepted, step.t});
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    const Vec3<double> mean = 0.5 * (u_start[k] + solution.velocity[k]), p = solution.impulse[k];
    double work = p.dot(mean), along = p.dot(c.normal) * mean.dot(c.normal);
    if (!c.predicted.isZero(0)) {
      const Vec3<double> other = 0.5 * (u_free[k] - solution.velocity[k]) - u_start[k];
      work += c.predicted.dot(other);
      along += c.predicted.dot(c.normal) * other.dot(c.normal);
    }
    state.work[static_cast<int>(Work::friction)] += work - along;
    state.work[static_cast<int>(Work::contact)] += along + (p - c.predicted).dot(c.prescribed_velocity);
  }
  problem.add_joint_impulses(record_.joint_impulses);
  problem.bound_shifts(motion.force_time, motion.h);
  if (!problem.has_predicted()) return solution;
  const std::vector<double> closing = problem.close_gaps();
  for (std::size_t k = 0; k < contacts.size(); ++k)
    state.work[static_cast<int>(Work::contact)] -=
        closing[k] * (u_free[k] - u_start[k]).dot(contacts[k].normal) / motion.h;
  return solution;
}

/// Appends contacts and impulses to the record of the step.
PLIANT_INLINE void ContactResolution::append_to_record(const std::vector<Contact>& contacts,
                                                       const ContactSolution& solution) {
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Vec3<double>&u = solution.velocity[k], &n = contacts[k].normal;
    record_.contacts.push_back(contacts[k]);
    record_.impulses.push_back(solution.impulse[k]);
    record_.sliding.push_back((u - u.dot(n) * n).norm());
  }
}

/// Resolves contacts once: applies the impulses, the displacements that they cause and their works. Then
/// separates overlaps, unless motion.h is zero or motion.separates is false. warm: see solve().
PLIANT_INLINE void ContactResolution::resolve_once(StepContext& step, const ResolvedMotion& motion,
                                                   const std::vector<Contact>& contacts, bool warm) {
  const State& before = motion.before;
  const double h = motion.h, t = step.t;
  State& state = step.state;
  const std::vector<int> parts = parts_touched(dynamics_.model(), contacts);
  const double work_before = state.work.sum();
  evaluate_touched(dynamics_, state, t, contacts, step.work);
  measure_travel(state, h, contacts);
  ContactProblem problem(dynamics_.model(), state, step.work, contacts, &before);
  const ContactSolution solution = solve(step, motion, contacts, warm, problem);
  // The work of solve() is not exact if a limit or a string has stopped a part within the motion, if a joint
  // follows a prescribed path, or if the impulse acts at one instant. It is also not exact at nodes of a mesh
  // and for parts with damping, because elastic and damping forces are not constant. Then Work::contact, or
  // Work::anchors for a prescribed path, is corrected: the sum of the works of this resolution becomes the
  // change of the energy of the touched parts.
  const bool driven = are_driven(dynamics_.model(), parts), instant = &before == &state,
             at_nodes = std::any_of(contacts.begin(), contacts.end(), is_at_nodes);
  std::optional<DampingWork> damping;
  if (!instant && motion.force_time < h && !at_nodes)
    damping.emplace(dynamics_, DampingWork::Starts{before.v, motion.v_unpredicted}, state,
                    contact_resolution::without_rebound(dynamics_.model(), contacts, parts), t, h);
  const bool damped = damping && damping->acts();
  const bool by_energy = driven || instant || damped || state.at_limit != before.at_limit ||
                         state.joints != before.joints || (at_nodes && motion.force_time < h);
  // Methods with a reach of 1 (FreeMotion::reach) conserve the energy at the positions half a step earlier.
  // solve() computes the work of impulses that cause displacements for the whole step (README.md). At nodes,
  // Work::contact gets the change of this energy between the state with these displacements and the actual
  // state.
  const bool by_displacement = at_nodes && !by_energy;
  const auto balance_of = [&](const State& at_end) {
    VecX<double> q = at_end.q;
    for (std::size_t i = 0; by_displacement && i < parts.size(); ++i)
      advance_whole_part(dynamics_.model().parts()[at(parts[i])], q, at_end.v, 0.5 * h - motion.force_time);
    return dynamics_.energy(t, q, at_end.v, parts, scratch_) - at_end.work.sum();
  };
  LoadWork loads(dynamics_, state);
  double balance = by_energy ? dynamics_.energy(t, state.q, state.v, parts, scratch_) - work_before : 0;
  State reference = by_displacement ? state : State();
  q_before_ejection_ = state.q;
  apply_solution(problem, dynamics_.model(), step.work, state);
  if (by_displacement) {
    reference = contact_resolution::displaced_evenly(problem, dynamics_.model(), step.work, motion.force_time,
                                                     std::move(reference));
    balance = balance_of(reference);
    state.work[static_cast<int>(Work::forces)] -= loads.work_until(t, reference);
  }
  if (h > 0) reconcile(step, parts);
  if (h > 0) add_ejections(state);
  // Adds the work of forces during the displacement by the impulses. Methods with a reach of 1 need this at
  // nodes only, because they compute the work of forces from the velocities at the start of the motion. For a
  // resting part they compute zero, which is right for impulses that cause displacements for h seconds.
  if (motion.force_time < h || by_displacement)
    state.work[static_cast<int>(Work::forces)] += loads.work_until(t, state);
  if (damped) damping->correct(state);
  if (h > 0 && motion.separates) separate_overlaps(step);
  project_limits(step);
  if (by_energy || by_displacement)
    state.work[static_cast<int>(driven ? Work::anchors : Work::contact)] += balance_of(state) - balance;
  append_to_record(contacts, solution);
  if (motion.separates) travel_.clear();
}

PLIANT_INLINE void ContactResolution::resolve_chain(StepContext& step, std::vector<Contact> resolved,
                                                    double min_impact_speed) {
  State& state = step.state;
  const double t = step.t;
  for (int link = 0; link < contact_resolution::kMaxChainLinks && !resolved.empty(); ++link) {
    const Pairs known(resolved);
    auto opening = [&](const Contact& contact) {
      return finder_.velocity(state, contact).dot(contact.normal);
    };
    auto is_impact = [&](const Contact& contact) {
      return contact.gap < -resting_.gap(contact) && opening(contact) < -min_impact_speed &&
             !known.has(contact, [&](const Contact& other) { return other.gap <= contact.gap; });
    };
    const std::vector<Contact>& near = resting_.near(state, t);
    if (std::none_of(near.begin(), near.end(), is_impact)) return;
    std::vector<Contact> contacts = near;
    double earliest = 0;  // time since the first of these impacts, s
    for (Contact& contact : contacts) {
      if (!is_impact(contact)) continue;
      const double u = opening(contact);
      contact.since = std::min(step.h, contact.gap / u);
      if (-contact.restitution * u > min_impact_speed) contact.rebound = -contact.restitution * u;
      earliest = std::max(earliest, contact.since);
    }
    contacts.erase(std::remove_if(contacts.begin(), contacts.end(),
                                  [&](const Contact& c) { return c.gap > resting_.gap(c); }),
                   contacts.end());
    meshes_.find(state, t, contacts);
    for (Contact& contact : contacts)
      if (contact.since == 0) contact.since = earliest;
    resolve_once(step, {state, 0, step.h}, contacts, false);
    resolved.insert(resolved.end(), contacts.begin(), contacts.end());
  }
  if (!resolved.empty()) ++step.counters.contact_cutoffs;
}

/// Sets the travel of the bodies of a contact to at least this distance, m.
PLIANT_INLINE void ContactResolution::extend_travel(const Contact& contact, double distance) {
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) travel_[at(side->part)] = std::max(travel_[at(side->part)], distance);
}

/// Adds ejections to the travel of each part: displacements of the part by the impulses at all contacts and
/// joints.
PLIANT_INLINE void ContactResolution::add_ejections(const State& state) {
  for (std::size_t i = 0; i < travel_.size(); ++i) {
    const PartModel& m = dynamics_.model().parts()[i];
    if (m.q0 < 0) continue;
    const auto change = state.q.segment(m.q0, m.n_q()) - q_before_ejection_.segment(m.q0, m.n_q());
    const double size = m.size;
    travel_[i] += change.head<3>().norm() + 2 * change.segment<4>(3).norm() * size;
    for (int k = 0; k < m.n_s; ++k) travel_[i] += lever(m, 6 + k) * std::abs(change[7 + k]);
    if (m.n_d() > 0)
      travel_[i] += local_levers(m).cwiseProduct(change.tail(m.n_d())).lpNorm<Eigen::Infinity>();
  }
}

}  // namespace pliant
