#include <pliant/contact/contact_resolution.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <pliant/math/disjoint_sets.h>
#include <pliant/math/index.h>
#include <pliant/project/project.h>

#include <pliant/contact/contact_pairs.h>
#include "load_work.h"
#include "touched_parts.h"

namespace pliant {

namespace {

/// Largest speed of separation, in sizes of the smaller body a second; faster bodies separate at their own
/// speed.
constexpr double kSeparationSpeed = 1;
constexpr int kMaxSeparationRounds = 16;
/// Most impacts in a chain of ejections in one step.
constexpr int kMaxChainLinks = 4;
/// Allowed overlap, relative to the gap of resting contacts.
constexpr double kAllowedOverlap = 1e-4;
/// Allowed overlap in units of rounding of positions.
constexpr double kUlps = 16;
/// Allowed overlap of meshes, relative to the gap of resting contacts.
constexpr double kMeshOverlap = 800;
/// Contacts within this share of the size of the smaller body are the same from step to step.
constexpr double kSameContact = 0.05;
/// Most steps in a row that warm-start.
constexpr int kMaxWarmStartAge = 10;
/// Tolerance of a separation, relative to the allowed overlap.
constexpr double kSeparationTolerance = 0.03;

bool of_meshes(const Contact& contact) {
  return contact.a.at_nodes() || contact.b.at_nodes();
}

/// Returns the number in [first, last) of the cached contact nearest to x, within `within` (m) and not taken,
/// or `last`. at(i) and is_taken(i) give its point and state.
template <class At, class IsTaken>
std::size_t nearest(std::size_t first, std::size_t last, const Vec3<double>& x, double within, At&& at,
                    IsTaken&& is_taken) {
  std::size_t found = last;
  for (std::size_t i = first; i < last; ++i) {
    const double distance = (at(i) - x).norm();
    if (!(distance < within) || is_taken(i)) continue;
    within = distance;
    found = i;
  }
  return found;
}

}  // namespace

void ContactRecord::clear() {
  contacts.clear();
  impulses.clear();
  sliding.clear();
  joint_impulses.setZero();
}

ContactResolution::ContactResolution(const Dynamics& dynamics, const ContactFinder& finder,
                                     MeshFinder& meshes, RestingContacts& resting, ContactRecord& record)
    : dynamics_(dynamics), finder_(finder), meshes_(meshes), resting_(resting), record_(record) {}

void ContactResolution::reconcile(StepContext& step, const std::vector<int>& parts) const {
  project_frames(step, parts);
  project_joints(step);
}

/// Returns the deviation of a point of a spinning part from its tangent in h seconds, m: it may strike within
/// a step and move away at the end.
double ContactResolution::sweep(const ContactSide& side, const Vec3<double>& x, const State& state,
                                double h) const {
  if (side.part < 0 || side.at_nodes()) return 0;
  const PartModel& m = dynamics_.model().parts()[at(side.part)];
  if (m.q0 < 0) return 0;
  const double turn = h * state.v.segment<3>(m.v0 + 3).norm();
  return 0.5 * turn * turn * (x - state.q.segment<3>(m.q0)).norm();
}

/// Returns the largest separation of a contact in h seconds, m: at kSeparationSpeed, plus the travel of its
/// bodies.
double ContactResolution::largest_separation(const Contact& contact, double h) const {
  double most = kSeparationSpeed * h * smaller_size(dynamics_.model(), contact);
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) most += travel_[at(side->part)];
  return most;
}

/// Returns the point of a contact in the frame of its part a, m: constant for a resting contact.
Vec3<double> ContactResolution::place(const Contact& contact, const State& state, double t) const {
  const Model& model = dynamics_.model();
  const int part = contact.a.part;
  return model.orientation(state, part, t).conjugate() * (contact.x - model.position(state, part, t));
}

/// Returns the distance within which contacts of a pair are the same, m.
double ContactResolution::same_within(const Contact& contact) const {
  return kSameContact * smaller_size(dynamics_.model(), contact);
}

void ContactResolution::begin_step(const State& state) {
  pushed_.clear();
  resolutions_ = 0;
  cold_start_ = state.contact_cache.empty() || state.contact_cache_age >= kMaxWarmStartAge;
}

/// Warm-starts the impulses from the forces of the contact cache, over h seconds.
void ContactResolution::warm_start(const State& state, double t, double h,
                                   const std::vector<Contact>& contacts, ContactProblem& problem) const {
  if (cold_start_) return;
  const std::vector<CachedContact>& contact_cache = state.contact_cache;
  std::vector<char> taken(contact_cache.size(), 0);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const auto [first, last] =
        std::equal_range(contact_cache.begin(), contact_cache.end(), contacts[k], ByPair{});
    if (first == last) continue;
    const auto end = static_cast<std::size_t>(last - contact_cache.begin());
    const std::size_t found = nearest(
        static_cast<std::size_t>(first - contact_cache.begin()), end, place(contacts[k], state, t),
        same_within(contacts[k]), [&](std::size_t i) { return contact_cache[i].x; },
        [&](std::size_t i) { return taken[i] != 0; });
    if (found == end) continue;
    taken[found] = 1;
    problem.warm_start_at(static_cast<int>(k), h * contact_cache[found].force);
  }
}

/// Records the impulses of the contacts for the cache.
void ContactResolution::note_pushed(const State& state, double t, const std::vector<Contact>& contacts,
                                    const ContactProblem& problem,
                                    const std::vector<Vec3<double>>& impulses) {
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (problem.may_warm_start(static_cast<int>(k)) && !impulses[k].isZero(0))
      pushed_.push_back({{key_of(contacts[k]), place(contacts[k], state, t), impulses[k]},
                         same_within(contacts[k]),
                         resolutions_});
  ++resolutions_;
}

void ContactResolution::end_step(double h, State& state) const {
  std::vector<Pushed> sorted = pushed_, merged;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Pushed& a, const Pushed& b) { return ByPair{}(a.support, b.support); });
  std::size_t first = 0;  // first contact of the same pair
  for (const Pushed& next : sorted) {
    if (merged.empty() || merged.back().support.between != next.support.between) first = merged.size();
    // The nearest contact of an earlier resolution is the same contact.
    const std::size_t same = nearest(
        first, merged.size(), next.support.x, next.same_within,
        [&](std::size_t i) { return merged[i].support.x; },
        [&](std::size_t i) { return merged[i].resolution == next.resolution; });
    if (same == merged.size()) {
      merged.push_back(next);
      continue;
    }
    merged[same].support.force += next.support.force;
    merged[same].resolution = next.resolution;
  }
  state.contact_cache.clear();
  for (const Pushed& pushed : merged)
    if (const Vec3<double> force = pushed.support.force / h; force.allFinite())
      state.contact_cache.push_back({pushed.support.between, pushed.support.x, force});
  state.contact_cache_age = cold_start_ || state.contact_cache.empty() ? 0 : state.contact_cache_age + 1;
}

void ContactResolution::resolve(StepContext& step, const ResolvedMotion& motion,
                                std::vector<Contact> contacts) {
  fully_separated_.clear();
  resolve_once(step, motion, std::move(contacts), motion.h > 0);
}

/// warm: whether the impulses start from the contact cache.
void ContactResolution::resolve_once(StepContext& step, const ResolvedMotion& motion,
                                     std::vector<Contact> contacts, bool warm) {
  const State& before = motion.before;
  const double h = motion.h, t = step.t;
  State& state = step.state;
  Workspace<double>& work = step.work;
  if (contacts.empty()) return;
  const std::vector<int> parts = parts_touched(dynamics_.model(), contacts);
  const double booked = state.work.sum();
  evaluate_touched(dynamics_, state, t, contacts, work);
  travel_.assign(dynamics_.model().parts().size(), 0);
  for (const Contact& contact : contacts) {
    const double opening = finder_.velocity(state, contact).dot(contact.normal);
    travel(contact, h * std::max(0.0, -opening) + sweep(contact.a, contact.x, state, h) +
                        sweep(contact.b, contact.x, state, h));
  }
  ContactProblem problem(dynamics_.model(), state, work, contacts);
  const std::vector<Vec3<double>> u_start = problem.velocities(before);
  if (warm) warm_start(state, t, h, contacts, problem);
  const ContactSolution solution = problem.solve(motion.held);
  if (h > 0) note_pushed(state, t, contacts, problem, solution.impulse);
  step.counters.contact_sweeps += solution.sweeps;
  step.counters.contact_fallbacks += solution.fallbacks;
  step.counters.contact_residual = std::max(step.counters.contact_residual, solution.residual);
  state.contact_residual = std::max(state.contact_residual, solution.residual);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    const Vec3<double> mean = 0.5 * (u_start[k] + solution.velocity[k]), p = solution.impulse[k];
    const double along = mean.dot(c.normal), p_n = p.dot(c.normal);
    state.work[static_cast<int>(Work::friction)] += p.dot(mean) - p_n * along;
    state.work[static_cast<int>(Work::contact)] += p_n * along + p.dot(c.carried);
  }
  problem.add_joint_impulses(record_.joint_impulses);
  problem.bound_shifts(motion.held, h);
  // The work of an impulse is that of a constant force over the step, to second order. If a limit or a string
  // acted within the step too, if prescribed ends of joints moved, or if the impulse acts at one moment, the
  // work is the change of the energy.
  const bool hands = are_driven(dynamics_.model(), parts), moment = &before == &state;
  const bool broken = hands || moment || state.at_limit != before.at_limit || state.joints != before.joints;
  const double energy = broken ? dynamics_.energy(t, state.q, state.v, parts, scratch_) : 0;
  LoadWork loads(dynamics_, state);
  ejected_from_ = state.q;
  move_by(problem, dynamics_.model(), work, state);
  if (h > 0) reconcile(step, parts);
  if (h > 0) add_ejections(state);
  // Methods that use the velocities at the end of a step book the work of forces by those at the start, which
  // is zero for resting bodies.
  if (motion.held < h) state.work[static_cast<int>(Work::forces)] += loads.until(t, state);
  if (h > 0) separate_overlaps(step);
  project_limits(step);
  if (broken)
    state.work[static_cast<int>(hands ? Work::anchors : Work::contact)] +=
        dynamics_.energy(t, state.q, state.v, parts, scratch_) - energy - (state.work.sum() - booked);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Vec3<double>&u = solution.velocity[k], &n = contacts[k].normal;
    record_.contacts.push_back(contacts[k]);
    record_.impulses.push_back(solution.impulse[k]);
    record_.sliding.push_back((u - u.dot(n) * n).norm());
  }
}

void ContactResolution::resolve_chain(StepContext& step, std::vector<Contact> resolved, double slow) {
  State& state = step.state;
  const double t = step.t;
  for (int link = 0; link < kMaxChainLinks && !resolved.empty(); ++link) {
    const Pairs known(resolved);
    std::vector<Contact> contacts = resting_.near(state, t);
    double earliest = 0;  // time since the earliest impact, s
    for (Contact& contact : contacts) {
      const double u = finder_.velocity(state, contact).dot(contact.normal);
      if (!(contact.gap < -resting_.gap(contact) && u < -slow) ||
          known.has(contact, [&](const Contact& other) { return other.gap <= contact.gap; }))
        continue;
      contact.since = std::min(step.h, contact.gap / u);
      if (-contact.restitution * u > slow) contact.rebound = -contact.restitution * u;
      earliest = std::max(earliest, contact.since);
    }
    if (earliest == 0) return;
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

/// Adds to the travel of the sides of a contact, m.
void ContactResolution::travel(const Contact& contact, double far) {
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) travel_[at(side->part)] = std::max(travel_[at(side->part)], far);
}

/// Adds the displacements by impulses at contacts and joints to the travel of parts.
void ContactResolution::add_ejections(const State& state) {
  for (std::size_t i = 0; i < travel_.size(); ++i) {
    const PartModel& m = dynamics_.model().parts()[i];
    if (m.q0 < 0) continue;
    const auto change = state.q.segment(m.q0, m.n_q()) - ejected_from_.segment(m.q0, m.n_q());
    const double size = m.part->size();
    travel_[i] += change.head<3>().norm() + 2 * change.segment<4>(3).norm() * size;
    for (int k = 0; k < m.n_s; ++k) {
      const bool length = m.part->parameters().moving(k).spec->quantity == Quantity::length;
      travel_[i] += (length ? 1 : size) * std::abs(change[7 + k]);
    }
    if (m.n_d() == 0) continue;
    const double unit = m.local->oscillators() != nullptr ? 1 / std::sqrt(m.part->total_mass()) : 1;
    travel_[i] += unit * change.tail(m.n_d()).lpNorm<Eigen::Infinity>();
  }
}

/// Returns the allowed overlap of a contact, m.
double ContactResolution::may_overlap(const Contact& contact) const {
  if (of_meshes(contact)) return kMeshOverlap * resting_.tight_gap(contact);
  double size = 0;
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) size = std::max(size, dynamics_.model().parts()[at(side->part)].part->size());
  const double rounding = std::numeric_limits<double>::epsilon() * (contact.x.norm() + size);
  return std::max(kAllowedOverlap * resting_.tight_gap(contact), kUlps * rounding);
}

/// Keeps the contacts that a separation of deep ones concerns: bodies that move as a whole with all that
/// touch them, and other contacts of the same pairs of meshes.
void ContactResolution::keep_concerned(std::vector<Contact>& contacts, const Workspace<double>& work) const {
  const Model& model = dynamics_.model();
  DisjointSets tied(model.parts().size());
  auto is_whole = [&](const ContactSide& side) {
    return side.part >= 0 && model.parts()[at(side.part)].q0 >= 0 &&
           !(side.at_nodes() && moves_by_nodes(model.parts()[at(side.part)], work.parts[at(side.part)]));
  };
  // The first part of each island.
  auto body_of = [&](int part) {
    const int island = model.parts()[at(part)].island;
    return tied.leader(island < 0 ? part : model.islands()[at(island)].parts.front());
  };
  for (const Contact& contact : contacts)
    if (is_whole(contact.a) && is_whole(contact.b))
      tied.unite(body_of(contact.a.part), body_of(contact.b.part));
  std::set<std::pair<int, int>> pairs;
  std::vector<bool> concerned(model.parts().size(), false);
  for (const Contact& contact : contacts) {
    if (!(contact.gap < -may_overlap(contact))) continue;
    if (of_meshes(contact)) pairs.insert({contact.a.part, contact.b.part});
    for (const ContactSide* side : {&contact.a, &contact.b})
      if (is_whole(*side)) concerned[at(body_of(side->part))] = true;
  }
  auto moves = [&](int part) { return part >= 0 && concerned[at(body_of(part))]; };
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(),
                     [&](const Contact& c) {
                       return !moves(c.a.part) && !moves(c.b.part) && pairs.count({c.a.part, c.b.part}) == 0;
                     }),
      contacts.end());
}

/// Separates overlapping bodies as far as the step allows. Bodies that this pushes into others separate
/// wholly.
void ContactResolution::separate_overlaps(StepContext& step) {
  State& state = step.state;
  Workspace<double>& work = step.work;
  const double h = step.h, t = step.t;
  for (int i = 0; i < kMaxSeparationRounds; ++i) {
    std::vector<Contact> found = resting_.near(state, t);
    double deepest = 0, most = 0;
    for (const Contact& contact : found) {
      deepest = std::max(deepest, -contact.gap);
      most = std::max(most, largest_separation(contact, h));
    }
    // The separation may bring them to other bodies at this distance.
    if (deepest > resting_.gap()) found = finder_.find(state, t, std::min(deepest, most));
    meshes_.find(state, t, found);
    std::vector<PairKey> deep;
    bool any = false;
    for (Contact& contact : found) {
      // Pairs that were separated as far as the step allows are only kept from approaching.
      if (fully_separated_.count(key_of(contact)) > 0) contact.gap = std::max(contact.gap, 0.0);
      if (i == 0 && contact.gap < -largest_separation(contact, h)) deep.push_back(key_of(contact));
      any = any || contact.gap < -may_overlap(contact);
    }
    if (!any) return;
    fully_separated_.insert(deep.begin(), deep.end());
    keep_concerned(found, work);
    double enough = std::numeric_limits<double>::infinity();
    for (const Contact& contact : found)
      enough = std::min(enough, kSeparationTolerance * may_overlap(contact));
    const std::vector<int> parts = parts_touched(dynamics_.model(), found);
    const double energy = dynamics_.energy(t, state.q, state.v, parts, scratch_), booked = state.work.sum();
    evaluate_touched(dynamics_, state, t, found, work);
    ContactProblem parting(dynamics_.model(), state, work, found);
    std::vector<double> limits;
    for (const Contact& contact : found) limits.push_back(largest_separation(contact, h));
    parting.separate_bodies(limits, enough);
    LoadWork loads(dynamics_, state);
    move_by(parting, dynamics_.model(), work, state);
    reconcile(step, parts);
    state.work[static_cast<int>(Work::forces)] += loads.until(t, state);
    state.work[static_cast<int>(Work::contact)] +=
        dynamics_.energy(t, state.q, state.v, parts, scratch_) - energy - (state.work.sum() - booked);
  }
  ++step.counters.contact_cutoffs;
}

}  // namespace pliant
