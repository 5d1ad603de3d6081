// Function bodies of impact_sequence.h.
#pragma once

#include <pliant/contact/impact_sequence.h>

#include <algorithm>
#include <utility>

#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/touched_parts.h>
#include <pliant/math/disjoint_sets.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace impact_sequence {

/// Largest number of impacts in a sequence: kMaxImpacts plus kMaxImpactsOfPair for each pair.
inline constexpr std::size_t kMaxImpacts = 1000, kMaxImpactsOfPair = 10;
/// Let a be the largest approach speed of connected bodies at the start. An approach is not treated as an
/// impact if its speed is at most kRounding * a, or at most kLeftPerTolerance * (tolerance of contact) * a.
/// The tolerance refers to the sum of approach and rebound, which is at most twice the approach speed.
inline constexpr double kRounding = 1e-10, kLeftPerTolerance = 2;
/// Approach speeds are equal if they differ by at most kEqualSpeed times the largest one, or by at most
/// kEqualResiduals times the residual of the impulses in this step and at most Pair::slowest.
inline constexpr double kEqualSpeed = 1e-9, kEqualResiduals = 2;

}  // namespace impact_sequence

/// Returns the speed with which the sides of a contact approach each other, m/s; negative: they separate.
PLIANT_INLINE double ImpactSequence::approach(const State& state, const Contact& contact) const {
  return -finder_.velocity(state, contact).dot(contact.normal);
}

PLIANT_INLINE double ImpactSequence::approach(const State& state, const Pair& pair) const {
  double fastest = 0;
  for (const Contact& contact : pair.contacts) fastest = std::max(fastest, approach(state, contact));
  return fastest;
}

PLIANT_INLINE std::vector<ImpactSequence::Pair> ImpactSequence::pairs_of(
    const State& state, const std::vector<Contact>& contacts) const {
  std::vector<Contact> sorted = contacts;
  std::stable_sort(sorted.begin(), sorted.end(), ByPair{});
  std::vector<Pair> pairs;
  for (const Contact& contact : sorted) {
    if (pairs.empty() || key_of(pairs.back().contacts.front()) != key_of(contact))
      pairs.push_back({{}, 0, 0});
    pairs.back().contacts.push_back(contact);
  }
  for (Pair& pair : pairs) pair.approach = approach(state, pair);
  return pairs;
}

/// Sets Pair::slowest of each pair: a share of the largest approach speed among all pairs that bodies connect
/// with this pair, but at least min_speed (m/s).
PLIANT_INLINE void ImpactSequence::set_slowest(const Model& model, double min_speed,
                                               std::vector<Pair>& pairs) {
  const double tolerance = model.body().contact.tolerance.value_or(0),
               share = std::max(impact_sequence::kRounding, impact_sequence::kLeftPerTolerance * tolerance);
  // The sets contain pairs and parts. A body is represented by the first part of its island.
  const std::size_t n = pairs.size();
  DisjointSets connected(n + model.parts().size());
  for (std::size_t k = 0; k < n; ++k)
    for (const int part : {pairs[k].contacts.front().a.part, pairs[k].contacts.front().b.part}) {
      if (part < 0 || model.parts()[at(part)].q0 < 0) continue;
      const int island = model.parts()[at(part)].island,
                first = island < 0 ? part : model.islands()[at(island)].parts.front();
      connected.unite(static_cast<int>(k), static_cast<int>(n) + first);
    }
  std::vector<double> largest(n + model.parts().size(), 0);  // of each set, m/s
  auto largest_of = [&](std::size_t k) -> double& {
    return largest[at(connected.root(static_cast<int>(k)))];
  };
  for (std::size_t k = 0; k < n; ++k) largest_of(k) = std::max(largest_of(k), pairs[k].approach);
  for (std::size_t k = 0; k < n; ++k) pairs[k].slowest = std::max(min_speed, share * largest_of(k));
}

/// Returns the contacts of all pairs that approach at least with the speed `least` (m/s), and sets their
/// rebounds. Sets the corrections of these rebounds (Contact::rebound in `pairs`) to zero, because the next
/// impact of the pair follows Newton's law without a correction.
PLIANT_INLINE std::vector<Contact> ImpactSequence::next_impacts(const State& state, double least,
                                                                double min_speed,
                                                                std::vector<Pair>& pairs) const {
  std::vector<Contact> impacts;
  for (Pair& pair : pairs) {
    if (!pair.has_impact() || pair.approach < least) continue;
    for (Contact& contact : pair.contacts) {
      impacts.push_back(contact);
      const double rebound = contact.restitution * approach(state, contact) + contact.rebound;
      impacts.back().rebound = rebound > min_speed ? rebound : 0;
      contact.rebound = 0;
    }
  }
  return impacts;
}

PLIANT_INLINE void ImpactSequence::resolve(StepContext& step, const std::vector<Contact>& contacts, double h,
                                           double min_speed) {
  State& state = step.state;
  if (std::none_of(contacts.begin(), contacts.end(), [](const Contact& c) { return c.restitution > 0; }))
    return;
  std::vector<Pair> pairs = pairs_of(state, contacts);
  set_slowest(step.model(), min_speed, pairs);
  const std::size_t max_impacts =
      impact_sequence::kMaxImpacts + impact_sequence::kMaxImpactsOfPair * pairs.size();
  for (std::size_t impacts = 0; impacts < max_impacts; ++impacts) {
    const Pair* first = nullptr;
    for (const Pair& pair : pairs)
      if (pair.has_impact() && (first == nullptr || pair.approach > first->approach)) first = &pair;
    if (first == nullptr) return;
    const double equal =
        std::max(impact_sequence::kEqualSpeed * first->approach,
                 std::min(impact_sequence::kEqualResiduals * state.contact_residual, first->slowest));
    const std::vector<Contact> next = next_impacts(state, first->approach - equal, min_speed, pairs);
    resolution_.resolve(step, {state, 0, h, false}, next);
    ++step.counters.sequential_impacts;
    const std::vector<int> moved = parts_touched(step.model(), next);
    auto has_moved = [&](const ContactSide& side) {
      return std::binary_search(moved.begin(), moved.end(), side.part);
    };
    for (Pair& pair : pairs)
      if (has_moved(pair.contacts.front().a) || has_moved(pair.contacts.front().b))
        pair.approach = approach(state, pair);
  }
  ++step.counters.contact_cutoffs;
}

}  // namespace pliant
