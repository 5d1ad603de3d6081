// Function bodies of contact_resolution.h: the separation of bodies that overlap, stage 7 of a step.
#pragma once

#include <pliant/contact/contact_resolution.h>

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include <pliant/body/speed_scale.h>
#include <pliant/contact/connected_bodies.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/load_work.h>
#include <pliant/contact/touched_parts.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace contact_separation {

/// Overlapping bodies are separated at most at this speed, in sizes of the smaller body times slow_rate(),
/// plus the speed of their own travel.
inline constexpr double kSeparationSpeed = 1;
/// Largest number of rounds of a separation. A round may push bodies into others, which the next round
/// separates.
inline constexpr int kMaxSeparationRounds = 16;
/// Overlaps below this share of the largest gap of a resting contact (RestingContacts::tight_gap) are not
/// separated.
inline constexpr double kAllowedOverlap = 1e-4;
/// With ContactSettings::tolerance, overlaps up to kOverlapPerTolerance times the tolerance, in sizes of the
/// smaller body, are not separated. They are limited to kMaxAllowedOverlap times RestingContacts::gap,
/// because a body that overlaps by more than this gap would rest at any velocity.
inline constexpr double kOverlapPerTolerance = 1e-3, kMaxAllowedOverlap = 0.5;
/// Overlaps up to this many units in the last place of the positions are not separated either.
inline constexpr double kRoundingUlps = 16;
/// Contacts at nodes of meshes may overlap by this multiple of RestingContacts::tight_gap.
inline constexpr double kMeshOverlap = 800;
/// Tolerance of the displacements of a separation, as a share of the smallest allowed_overlap().
inline constexpr double kSeparationTolerance = 0.03;

}  // namespace contact_separation

/// Returns the distance (m) by which a contact may be opened in a step of h seconds: the distance at
/// kSeparationSpeed plus the travel of its bodies.
PLIANT_INLINE double ContactResolution::largest_separation(const Contact& contact, double h) const {
  const Model& model = dynamics_.model();
  double distance =
      contact_separation::kSeparationSpeed * (slow_rate(model) * h) * smaller_size(model, contact);
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) distance += travel_[at(side->part)];
  return distance;
}

/// Returns the depth (m) up to which an overlap at a contact is not separated.
PLIANT_INLINE double ContactResolution::allowed_overlap(const Contact& contact) const {
  if (is_at_nodes(contact)) return contact_separation::kMeshOverlap * resting_.tight_gap(contact);
  double size = 0;
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) size = std::max(size, dynamics_.model().parts()[at(side->part)].size);
  const double rounding = std::numeric_limits<double>::epsilon() * (contact.x.norm() + size);
  const double tolerance = dynamics_.model().body().contact.tolerance.value_or(0),
               loose = std::min(contact_separation::kOverlapPerTolerance * tolerance *
                                    smaller_size(dynamics_.model(), contact),
                                contact_separation::kMaxAllowedOverlap * resting_.gap(contact));
  return std::max({contact_separation::kAllowedOverlap * resting_.tight_gap(contact), loose,
                   contact_separation::kRoundingUlps * rounding});
}

/// Records the overlaps that remain at time t (s). The tolerance of the record is allowed_overlap(), or
/// RestingContacts::tight_gap if that is larger.
PLIANT_INLINE void ContactResolution::record_overlaps(const std::vector<Contact>& contacts, double t) {
  record_.overlap = 0;
  record_.worst_overlap = {};
  for (const Contact& contact : contacts) {
    if (!(contact.gap < 0)) continue;
    record_.overlap = std::max(record_.overlap, -contact.gap);
    record_.worst_overlap.keep_worse(
        {-contact.gap, std::max(allowed_overlap(contact), resting_.tight_gap(contact)), t});
  }
}

/// Keeps the contacts that the separation of deep contacts affects. These are the contacts of bodies that
/// move as a whole and are connected by contacts to a body with a deep contact. If a pair has a deep contact
/// at nodes of a mesh, all contacts of this pair are kept, too.
PLIANT_INLINE void ContactResolution::keep_affected(std::vector<Contact>& contacts,
                                                    const Workspace<double>& work) const {
  const Model& model = dynamics_.model();
  ConnectedBodies connected(model);
  auto is_whole = [&](const ContactSide& side) {
    return side.part >= 0 && model.parts()[at(side.part)].q0 >= 0 &&
           !(side.at_nodes() && moves_by_nodes(model.parts()[at(side.part)], work.parts[at(side.part)]));
  };
  for (const Contact& contact : contacts)
    if (is_whole(contact.a) && is_whole(contact.b)) connected.connect(contact.a.part, contact.b.part);
  std::set<std::pair<int, int>> pairs;
  std::vector<bool> affected(model.parts().size(), false);
  for (const Contact& contact : contacts) {
    if (!(contact.gap < -allowed_overlap(contact))) continue;
    if (is_at_nodes(contact)) pairs.insert({contact.a.part, contact.b.part});
    for (const ContactSide* side : {&contact.a, &contact.b})
      if (is_whole(*side)) affected[at(connected.set_of(side->part, -1))] = true;
  }
  auto moves = [&](int part) {
    const int set = connected.set_of(part, -1);
    return set >= 0 && affected[at(set)];
  };
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(),
                     [&](const Contact& c) {
                       return !moves(c.a.part) && !moves(c.b.part) && pairs.count({c.a.part, c.b.part}) == 0;
                     }),
      contacts.end());
}

/// Returns whether no contact is deeper than its allowed overlap. For an overlap deeper than
/// RestingContacts::gap it returns false, because contacts_to_separate() then searches farther.
PLIANT_INLINE bool ContactResolution::is_separated(const std::vector<Contact>& contacts) const {
  return std::all_of(contacts.begin(), contacts.end(), [&](const Contact& contact) {
    return contact.gap >= 0 || contact.gap >= -std::min(allowed_overlap(contact), resting_.gap());
  });
}

/// Returns the contacts at a state, and the contacts between bodies that a separation may push together.
PLIANT_INLINE std::vector<Contact> ContactResolution::contacts_to_separate(const StepContext& step) {
  const State& state = step.state;
  std::vector<Contact> found = resting_.near(state, step.t);
  double deepest = 0, largest = 0;
  for (const Contact& contact : found) {
    deepest = std::max(deepest, -contact.gap);
    largest = std::max(largest, largest_separation(contact, step.h));
  }
  if (deepest > resting_.gap()) found = finder_.find(state, step.t, std::min(deepest, largest));
  meshes_.find(state, step.t, found);
  return found;
}

/// One round of a separation: displaces the bodies at some contacts, and adds the work of this displacement.
PLIANT_INLINE void ContactResolution::separate(StepContext& step, const std::vector<Contact>& contacts) {
  State& state = step.state;
  const double t = step.t;
  double tolerance = std::numeric_limits<double>::infinity();
  std::vector<double> max_separation;
  for (const Contact& contact : contacts) {
    tolerance = std::min(tolerance, contact_separation::kSeparationTolerance * allowed_overlap(contact));
    max_separation.push_back(largest_separation(contact, step.h));
  }
  const std::vector<int> parts = parts_touched(dynamics_.model(), contacts);
  const double energy = dynamics_.energy(t, state.q, state.v, parts, scratch_),
               work_before = state.work.sum();
  evaluate_touched(dynamics_, state, t, contacts, step.work);
  ContactProblem separation(dynamics_.model(), state, step.work, contacts);
  separation.separate_bodies(max_separation, tolerance);
  LoadWork loads(dynamics_, state);
  apply_solution(separation, dynamics_.model(), step.work, state);
  reconcile(step, parts);
  state.work[static_cast<int>(Work::forces)] += loads.work_until(t, state);
  state.work[static_cast<int>(Work::contact)] +=
      dynamics_.energy(t, state.q, state.v, parts, scratch_) - energy - (state.work.sum() - work_before);
}

/// Stage 7 of a step: separates bodies that overlap, by at most the distance that a step of h seconds allows
/// (largest_separation()). Bodies that this separation pushes into others are separated completely. Records
/// the overlaps that remain.
PLIANT_INLINE void ContactResolution::separate_overlaps(StepContext& step) {
  for (int i = 0;; ++i) {
    const std::vector<Contact>& near = resting_.near(step.state, step.t);
    if (meshes_.empty() && is_separated(near)) return record_overlaps(near, step.t);
    std::vector<Contact> found = contacts_to_separate(step);
    record_overlaps(found, step.t);
    std::vector<PairKey> too_deep;
    bool any_deep = false;
    for (Contact& contact : found) {
      // The next steps remove the remaining overlap of a pair that was separated by its allowed distance.
      if (fully_separated_.count(key_of(contact)) > 0) contact.gap = std::max(contact.gap, 0.0);
      if (i == 0 && contact.gap < -largest_separation(contact, step.h)) too_deep.push_back(key_of(contact));
      any_deep = any_deep || contact.gap < -allowed_overlap(contact);
    }
    if (!any_deep) return;
    if (i == contact_separation::kMaxSeparationRounds) break;
    fully_separated_.insert(too_deep.begin(), too_deep.end());
    keep_affected(found, step.work);
    separate(step, found);
  }
  ++step.counters.contact_cutoffs;
}

}  // namespace pliant
