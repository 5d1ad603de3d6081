#include <pliant/integrate/contact_settling.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include <pliant/integrate/settle.h>
#include <pliant/math/disjoint_sets.h>
#include <pliant/math/index.h>

#include "contact_pairs.h"
#include "load_work.h"
#include "pushed_parts.h"

namespace pliant {

namespace {

/// Bodies that overlap are parted at most at this speed, in sizes of the smaller a second, or as fast as they
/// move.
constexpr double kPartingSpeed = 1;
constexpr int kMostPartings = 16;
/// Most times in a step that bodies which impulses throw meet others.
constexpr int kMostLinks = 4;
/// Overlaps below this share of what counts as resting are left.
constexpr double kLeftOverlap = 1e-4;
/// As are those of so many units of rounding of places.
constexpr double kUlps = 16;
/// Meshes may overlap by this many times what counts as resting without being parted.
constexpr double kMeshOverlap = 800;
/// Contacts within this share of the smaller body's size of each other are the same from step to step.
constexpr double kSameSupport = 0.05;
/// So many steps in a row begin at the forces before.
constexpr int kMostAge = 10;
/// What is parted may overlap by this share of what would be left.
constexpr double kPartedLeft = 0.03;

bool of_meshes(const Contact& contact) {
  return contact.a.at_nodes() || contact.b.at_nodes();
}

/// The number of the support of [first, last) that is nearest to a place of the same part, nearer than
/// `within` (m) and not taken; `last` if there is none. at and is_taken: of a number.
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

ContactSettling::ContactSettling(const Dynamics& dynamics, const ContactFinder& finder, MeshFinder& meshes,
                                 RestingContacts& resting, ContactRecord& record)
    : dynamics_(dynamics), finder_(finder), meshes_(meshes), resting_(resting), record_(record) {}

void ContactSettling::reconcile(const std::vector<int>& parts, State& state, double t,
                                Workspace<double>& work, StepCounters& counters) const {
  settle_frames(dynamics_, t, parts, state, work);
  settle_joints(dynamics_, t, state, work, counters);
}

/// How far a point of a part that spins leaves its tangent in h seconds, m: it may come round and strike
/// within a step, and move away at its end.
double ContactSettling::swing(const ContactSide& side, const Vec3<double>& x, const State& state,
                              double h) const {
  if (side.part < 0 || side.at_nodes()) return 0;
  const PartModel& m = dynamics_.model().parts()[at(side.part)];
  if (m.q0 < 0) return 0;
  const double turn = h * state.v.segment<3>(m.v0 + 3).norm();
  return 0.5 * turn * turn * (x - state.q.segment<3>(m.q0)).norm();
}

/// How far a contact may be parted in a step of h seconds, m: at kPartingSpeed, and as far as its bodies go.
double ContactSettling::most_parting(const Contact& contact, double h) const {
  double most = kPartingSpeed * h * smaller_size(dynamics_.model(), contact);
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) most += went_[at(side->part)];
  return most;
}

/// Where a contact is in the frame of its part a, m: what rests stays there, whatever its bodies do.
Vec3<double> ContactSettling::place(const Contact& contact, const State& state, double t) const {
  const Model& model = dynamics_.model();
  const int part = contact.a.part;
  return model.orientation(state, part, t).conjugate() * (contact.x - model.position(state, part, t));
}

/// Contacts of a pair that are nearer than this, m, are the same.
double ContactSettling::same_within(const Contact& contact) const {
  return kSameSupport * smaller_size(dynamics_.model(), contact);
}

void ContactSettling::begin_step(const State& state) {
  pushed_.clear();
  settlements_ = 0;
  begins_anew_ = state.supports.empty() || state.supports_age >= kMostAge;
}

/// The search for impulses begins at those of h seconds by the forces of the step before.
void ContactSettling::begin_at_supports(const State& state, double t, double h,
                                        const std::vector<Contact>& contacts, ContactProblem& problem) const {
  if (begins_anew_) return;
  const std::vector<Support>& supports = state.supports;
  std::vector<char> taken(supports.size(), 0);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const auto [first, last] = std::equal_range(supports.begin(), supports.end(), contacts[k], ByPair{});
    if (first == last) continue;
    const auto end = static_cast<std::size_t>(last - supports.begin());
    const std::size_t found = nearest(
        static_cast<std::size_t>(first - supports.begin()), end, place(contacts[k], state, t),
        same_within(contacts[k]), [&](std::size_t i) { return supports[i].x; },
        [&](std::size_t i) { return taken[i] != 0; });
    if (found == end) continue;
    taken[found] = 1;
    problem.begin_at(static_cast<int>(k), h * supports[found].force);
  }
}

/// What contacts took is known as pushed.
void ContactSettling::note_pushed(const State& state, double t, const std::vector<Contact>& contacts,
                                  const ContactProblem& problem, const std::vector<Vec3<double>>& impulses) {
  for (std::size_t k = 0; k < contacts.size(); ++k)
    if (problem.may_begin(static_cast<int>(k)) && !impulses[k].isZero(0))
      pushed_.push_back({{key_of(contacts[k]), place(contacts[k], state, t), impulses[k]},
                         same_within(contacts[k]),
                         settlements_});
  ++settlements_;
}

void ContactSettling::end_step(double h, State& state) const {
  std::vector<Pushed> sorted = pushed_, merged;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Pushed& a, const Pushed& b) { return ByPair{}(a.support, b.support); });
  std::size_t first = 0;  // of the same pair
  for (const Pushed& next : sorted) {
    if (merged.empty() || merged.back().support.between != next.support.between) first = merged.size();
    // The nearest of an earlier settlement is the same contact.
    const std::size_t same = nearest(
        first, merged.size(), next.support.x, next.same_within,
        [&](std::size_t i) { return merged[i].support.x; },
        [&](std::size_t i) { return merged[i].settlement == next.settlement; });
    if (same == merged.size()) {
      merged.push_back(next);
      continue;
    }
    merged[same].support.force += next.support.force;
    merged[same].settlement = next.settlement;
  }
  state.supports.clear();
  for (const Pushed& pushed : merged)
    if (const Vec3<double> force = pushed.support.force / h; force.allFinite())
      state.supports.push_back({pushed.support.between, pushed.support.x, force});
  state.supports_age = begins_anew_ || state.supports.empty() ? 0 : state.supports_age + 1;
}

void ContactSettling::settle(const State& before, double since_of_limits, double h, State& state, double t,
                             std::vector<Contact> contacts, Workspace<double>& work, StepCounters& counters) {
  parted_enough_.clear();
  settle_once(before, since_of_limits, h, state, t, std::move(contacts), h > 0, work, counters);
}

/// begins: whether the search begins at what took something of the step before.
void ContactSettling::settle_once(const State& before, double since_of_limits, double h, State& state,
                                  double t, std::vector<Contact> contacts, bool begins,
                                  Workspace<double>& work, StepCounters& counters) {
  if (contacts.empty()) return;
  const std::vector<int> parts = parts_touched(dynamics_.model(), contacts);
  const double booked = state.work.sum();
  evaluate_touched(dynamics_, state, t, contacts, work);
  went_.assign(dynamics_.model().parts().size(), 0);
  for (const Contact& contact : contacts) {
    const double opening = finder_.velocity(state, contact).dot(contact.normal);
    went(contact, h * std::max(0.0, -opening) + swing(contact.a, contact.x, state, h) +
                      swing(contact.b, contact.x, state, h));
  }
  ContactProblem problem(dynamics_.model(), state, work, contacts);
  const std::vector<Vec3<double>> u_start = problem.velocities(before);
  if (begins) begin_at_supports(state, t, h, contacts, problem);
  const ContactSolution solution = problem.solve(since_of_limits);
  if (h > 0) note_pushed(state, t, contacts, problem, solution.impulse);
  counters.contact_sweeps += solution.sweeps;
  counters.contact_fallbacks += solution.fallbacks;
  counters.contact_residual = std::max(counters.contact_residual, solution.residual);
  state.contact_residual = std::max(state.contact_residual, solution.residual);
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    const Contact& c = contacts[k];
    const Vec3<double> mean = 0.5 * (u_start[k] + solution.velocity[k]), p = solution.impulse[k];
    const double along = mean.dot(c.normal), p_n = p.dot(c.normal);
    state.work[static_cast<int>(Work::friction)] += p.dot(mean) - p_n * along;
    state.work[static_cast<int>(Work::contact)] += p_n * along + p.dot(c.carried);
  }
  problem.add_joint_impulses(record_.joint_impulses);
  problem.bound_shifts(since_of_limits, h);
  // The work of an impulse is that of a constant force over the step, to second order; where a limit or a
  // string has stopped something within it too, it is what the energy changes by. So is that of hands that
  // move joints, on which impulses push back, and of impulses at one moment.
  const bool hands = are_driven(dynamics_.model(), parts), moment = &before == &state;
  const bool broken = hands || moment || state.at_limit != before.at_limit || state.joints != before.joints;
  const double energy = broken ? dynamics_.energy(t, state.q, state.v, parts, scratch_) : 0;
  LoadWork loads(dynamics_, state);
  thrown_from_ = state.q;
  move_by(problem, dynamics_.model(), work, state);
  if (h > 0) reconcile(parts, state, t, work, counters);
  if (h > 0) add_throws(state);
  // Methods that go by the velocities at a step's end book what forces do by those at its start: to what
  // rests they do nothing.
  if (since_of_limits < h) state.work[static_cast<int>(Work::forces)] += loads.until(t, state);
  if (h > 0) part_overlaps(h, state, t, work, counters);
  settle_limits(dynamics_, t, state, work, counters);
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

void ContactSettling::settle_chain(std::vector<Contact> settled, double h, double slow, State& state,
                                   double t, Workspace<double>& work, StepCounters& counters) {
  for (int link = 0; link < kMostLinks && !settled.empty(); ++link) {
    const Pairs known(settled);
    std::vector<Contact> contacts = resting_.near(state, t);
    double earliest = 0;  // how long ago, s
    for (Contact& contact : contacts) {
      const double u = finder_.velocity(state, contact).dot(contact.normal);
      if (!(contact.gap < -resting_.gap(contact) && u < -slow) ||
          known.has(contact, [&](const Contact& other) { return other.gap <= contact.gap; }))
        continue;
      contact.since = std::min(h, contact.gap / u);
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
    settle_once(state, 0, h, state, t, contacts, false, work, counters);
    settled.insert(settled.end(), contacts.begin(), contacts.end());
  }
  if (!settled.empty()) ++counters.contact_cutoffs;
}

/// Sides of a contact go this much farther, m.
void ContactSettling::went(const Contact& contact, double far) {
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) went_[at(side->part)] = std::max(went_[at(side->part)], far);
}

/// Parts go farther by as much as impulses, at all their contacts and joints, have thrown them.
void ContactSettling::add_throws(const State& state) {
  for (std::size_t i = 0; i < went_.size(); ++i) {
    const PartModel& m = dynamics_.model().parts()[i];
    if (m.q0 < 0) continue;
    const auto change = state.q.segment(m.q0, m.n_q()) - thrown_from_.segment(m.q0, m.n_q());
    const double size = m.part->size();
    went_[i] += change.head<3>().norm() + 2 * change.segment<4>(3).norm() * size;
    for (int k = 0; k < m.n_s; ++k) {
      const bool length = m.part->parameters().moving(k).spec->quantity == Quantity::length;
      went_[i] += (length ? 1 : size) * std::abs(change[7 + k]);
    }
    if (m.n_d() == 0) continue;
    const double unit = m.local->oscillators() != nullptr ? 1 / std::sqrt(m.part->total_mass()) : 1;
    went_[i] += unit * change.tail(m.n_d()).lpNorm<Eigen::Infinity>();
  }
}

/// How deep a contact may be without being parted, m.
double ContactSettling::may_overlap(const Contact& contact) const {
  if (of_meshes(contact)) return kMeshOverlap * resting_.tight_gap(contact);
  double size = 0;
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) size = std::max(size, dynamics_.model().parts()[at(side->part)].part->size());
  const double rounding = std::numeric_limits<double>::epsilon() * (contact.x.norm() + size);
  return std::max(kLeftOverlap * resting_.tight_gap(contact), kUlps * rounding);
}

/// What parting the deep ones of some contacts moves: bodies that move as a whole, with all such that touch
/// them, and of meshes others of the same pairs.
void ContactSettling::keep_concerned(std::vector<Contact>& contacts, const Workspace<double>& work) const {
  const Model& model = dynamics_.model();
  DisjointSets tied(model.parts().size());
  auto is_whole = [&](const ContactSide& side) {
    return side.part >= 0 && model.parts()[at(side.part)].q0 >= 0 &&
           !(side.at_nodes() && moves_by_nodes(model.parts()[at(side.part)], work.parts[at(side.part)]));
  };
  // Of what joints tie together the first part.
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

/// Moves bodies that overlap apart, by what a step of h seconds lets them be; those that this pushes into
/// others wholly.
void ContactSettling::part_overlaps(double h, State& state, double t, Workspace<double>& work,
                                    StepCounters& counters) {
  for (int i = 0; i < kMostPartings; ++i) {
    std::vector<Contact> found = resting_.near(state, t);
    double deepest = 0, most = 0;
    for (const Contact& contact : found) {
      deepest = std::max(deepest, -contact.gap);
      most = std::max(most, most_parting(contact, h));
    }
    // Parted by so much, they may meet what is as near.
    if (deepest > resting_.gap()) found = finder_.find(state, t, std::min(deepest, most));
    meshes_.find(state, t, found);
    std::vector<PairKey> deep;
    bool any = false;
    for (Contact& contact : found) {
      // What has been parted as far as the step lets it comes no nearer, and that is all.
      if (parted_enough_.count(key_of(contact)) > 0) contact.gap = std::max(contact.gap, 0.0);
      if (i == 0 && contact.gap < -most_parting(contact, h)) deep.push_back(key_of(contact));
      any = any || contact.gap < -may_overlap(contact);
    }
    if (!any) return;
    parted_enough_.insert(deep.begin(), deep.end());
    keep_concerned(found, work);
    double enough = std::numeric_limits<double>::infinity();
    for (const Contact& contact : found) enough = std::min(enough, kPartedLeft * may_overlap(contact));
    const std::vector<int> parts = parts_touched(dynamics_.model(), found);
    const double energy = dynamics_.energy(t, state.q, state.v, parts, scratch_), booked = state.work.sum();
    evaluate_touched(dynamics_, state, t, found, work);
    ContactProblem parting(dynamics_.model(), state, work, found);
    std::vector<double> limits;
    for (const Contact& contact : found) limits.push_back(most_parting(contact, h));
    parting.part_bodies(limits, enough);
    LoadWork loads(dynamics_, state);
    move_by(parting, dynamics_.model(), work, state);
    reconcile(parts, state, t, work, counters);
    state.work[static_cast<int>(Work::forces)] += loads.until(t, state);
    state.work[static_cast<int>(Work::contact)] +=
        dynamics_.energy(t, state.q, state.v, parts, scratch_) - energy - (state.work.sum() - booked);
  }
  ++counters.contact_cutoffs;
}

}  // namespace pliant
