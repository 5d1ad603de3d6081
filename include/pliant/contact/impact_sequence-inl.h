// Function bodies of impact_sequence.h.
#pragma once

#include <pliant/contact/impact_sequence.h>

#include <algorithm>
#include <utility>

#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/touched_parts.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace impact_sequence {

/// Largest number of impacts in a sequence: kMaxImpacts, and kMaxImpactsOfPair more for each pair.
inline constexpr std::size_t kMaxImpacts = 1000, kMaxImpactsOfPair = 10;
/// Approach speeds up to this share of the largest one at the start are rounding.
inline constexpr double kRounding = 1e-10;
/// Approach speeds that differ by at most this share are equal.
inline constexpr double kEqualSpeed = 1e-9;

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
    if (pairs.empty() || key_of(pairs.back().contacts.front()) != key_of(contact)) pairs.push_back({{}, 0});
    pairs.back().contacts.push_back(contact);
  }
  for (Pair& pair : pairs) pair.approach = approach(state, pair);
  return pairs;
}

/// Returns the contacts of all pairs that approach with the largest speed, `fastest`, and sets their
/// rebounds. In the pairs the rebounds of these contacts become zero: their next impact follows Newton's law.
PLIANT_INLINE std::vector<Contact> ImpactSequence::next_impacts(const State& state, double fastest,
                                                                double min_speed,
                                                                std::vector<Pair>& pairs) const {
  std::vector<Contact> impacts;
  for (Pair& pair : pairs) {
    if (pair.approach < (1 - impact_sequence::kEqualSpeed) * fastest) continue;
    for (Contact& contact : pair.contacts) {
      impacts.push_back(contact);
      const double rebound = contact.restitution * approach(state, contact);
      if (contact.rebound == 0 && rebound > min_speed) impacts.back().rebound = rebound;
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
  double slowest = min_speed;
  for (const Pair& pair : pairs) slowest = std::max(slowest, impact_sequence::kRounding * pair.approach);
  const std::size_t max_impacts =
      impact_sequence::kMaxImpacts + impact_sequence::kMaxImpactsOfPair * pairs.size();
  for (std::size_t impacts = 0; impacts < max_impacts; ++impacts) {
    double fastest = 0;
    for (const Pair& pair : pairs) fastest = std::max(fastest, pair.approach);
    if (!(fastest > slowest)) return;
    const std::vector<Contact> next = next_impacts(state, fastest, min_speed, pairs);
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
