// Function bodies of resting_contacts.h: which contacts rest, and how long a motion without impulses between
// them may be.
#pragma once

#include <pliant/contact/resting_contacts.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <pliant/contact/contact_pairs.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace resting_contacts {

/// Largest gap of a resting contact, in sizes of the smaller part.
inline constexpr double kRestingGap = 1e-6;
/// The residual of the contact solution may widen this gap by at most this multiple of the gap.
inline constexpr double kMaxWidening = 1000;
/// If at most this share of the parts has moved, only these parts are searched again.
inline constexpr double kFewMovedParts = 0.7;
/// Predicted impulses open a contact by at most this multiple of Contact::lift, even if its force ceases in
/// the motion.
inline constexpr double kLifts = 2;
/// Two contacts of a pair, at the start and at the end of a motion, are treated as one contact if their
/// contact points are nearer than this, in sizes of the smaller part.
inline constexpr double kSamePoint = 0.2;
/// The corresponding distance for contacts with predicted impulses. This distance is larger, because these
/// are contacts of round parts, which roll. The scalar product of both normals must also be at least
/// kSameNormals.
inline constexpr double kSamePredictedPoint = 0.5, kSameNormals = 0.7;
/// The length of a motion that is predicted or repeated is at most this share of the length in which a
/// resting contact sinks by ContactFinder::max_resolved_depth.
inline constexpr double kRepeatShare = 0.95;

}  // namespace resting_contacts

PLIANT_INLINE RestingContacts::RestingContacts(const Model& model, const ContactFinder& finder)
    : model_(model), finder_(finder) {
  for (const PartModel& m : model.parts()) gap_ = std::max(gap_, resting_contacts::kRestingGap * m.size);
}

PLIANT_INLINE void RestingContacts::widen_gap(double extra) {
  if (extra != extra_gap_) last_q_.resize(0);
  extra_gap_ = extra;
}

PLIANT_INLINE double RestingContacts::widened(double tight) const {
  return tight + std::min(extra_gap_, resting_contacts::kMaxWidening * tight);
}

PLIANT_INLINE double RestingContacts::tight_gap(const Contact& contact) const {
  return resting_contacts::kRestingGap * smaller_size(model_, contact);
}

/// Marks the parts that have moved since the last search. Returns whether only few parts have moved.
PLIANT_INLINE bool RestingContacts::few_moved(const State& state) {
  moved_.assign(model_.parts().size(), false);
  int count = 0;
  for (int i = 0; i < static_cast<int>(model_.parts().size()); ++i) {
    const PartModel& m = model_.parts()[at(i)];
    if (m.q0 < 0 || state.q.segment(m.q0, m.n_q()) == last_q_.segment(m.q0, m.n_q())) continue;
    moved_[at(i)] = true;
    ++count;
  }
  return count <= resting_contacts::kFewMovedParts * static_cast<double>(model_.parts().size());
}

PLIANT_INLINE const std::vector<Contact>& RestingContacts::near(const State& state, double t) {
  const bool same_time =
      last_q_.size() == state.q.size() && last_t_ == t && same_sleepers(last_at_rest_, state.at_rest);
  if (same_time && last_q_ == state.q) return last_;
  if (same_time && few_moved(state)) {
    const std::vector<Contact> found = finder_.find(state, t, gap(), &moved_);
    last_.erase(std::remove_if(last_.begin(), last_.end(),
                               [&](const Contact& c) {
                                 return moved_[at(c.a.part)] || (c.b.part >= 0 && moved_[at(c.b.part)]);
                               }),
                last_.end());
    const std::vector<Contact> unmoved = std::move(last_);
    last_.clear();
    std::merge(unmoved.begin(), unmoved.end(), found.begin(), found.end(), std::back_inserter(last_),
               ContactFinder::precedes);
  } else {
    last_ = finder_.find(state, t, gap());
  }
  last_q_ = state.q;
  last_at_rest_ = state.at_rest;
  last_t_ = t;
  return last_;
}

/// Returns whether a contact with this gap (m) and this normal velocity (m/s) rests. A contact that overlaps
/// by more than the largest gap of resting contacts rests at any velocity.
PLIANT_INLINE bool RestingContacts::is_resting(const Contact& contact, double gap, double velocity,
                                               double max_speed) const {
  const double max_gap = this->gap(contact);
  return gap < -max_gap || (gap <= max_gap && std::abs(velocity) <= max_speed);
}

PLIANT_INLINE double RestingContacts::max_speed(const FreeMotion& motion, const Contact& contact) const {
  if (motion.max_inelastic_speed == motion.max_resting_speed || contact.restitution > 0)
    return motion.max_resting_speed;
  return finder_.is_smooth(contact) ? motion.max_inelastic_speed : motion.max_resting_speed;
}

PLIANT_INLINE std::vector<Contact> RestingContacts::at_rest(const State& state, double t,
                                                            const FreeMotion& motion) {
  const std::vector<Contact>& all = near(state, t);
  std::vector<Contact> resting;
  resting.reserve(all.size());
  std::copy_if(all.begin(), all.end(), std::back_inserter(resting), [&](const Contact& c) {
    return is_resting(c, c.gap, finder_.velocity(state, c).dot(c.normal), max_speed(motion, c));
  });
  return resting;
}

/// Returns whether a contact at the end of a motion rested at its start, from the velocities of its sides.
/// Two flat surfaces in contact may touch at a new contact point, so that no contact point at the start is
/// near.
PLIANT_INLINE bool RestingContacts::was_resting(const Contact& contact, const FreeMotion& motion,
                                                const State& state) const {
  const double u_start = finder_.velocity(motion.before, contact).dot(contact.normal),
               u = finder_.velocity(state, contact).dot(contact.normal),
               opening = motion.h * ((1 - motion.reach) * u_start + motion.reach * u);
  return is_resting(contact, contact.gap - opening, u_start, max_speed(motion, contact));
}

PLIANT_INLINE double RestingContacts::longest(const FreeMotion& motion, const std::vector<Contact>& resting,
                                              double gravity) const {
  double longest = motion.h;
  for (const Contact& contact : resting)
    longest =
        std::min(longest, resting_contacts::kRepeatShare *
                              std::sqrt(finder_.max_resolved_depth(contact) / (motion.reach * gravity)));
  return longest;
}

PLIANT_INLINE double RestingContacts::longest(const FreeMotion& motion, const std::vector<Contact>& resting,
                                              const State& state) const {
  double longest = motion.h;
  for (const Contact& contact : resting) {
    const Vec3<double> displacement =
        motion.h * ((1 - motion.reach) * finder_.velocity(motion.before, contact) +
                    motion.reach * finder_.velocity(state, contact));
    const double share = std::abs(displacement.dot(contact.normal)) / finder_.max_resolved_depth(contact);
    if (share > 1) longest = std::min(longest, resting_contacts::kRepeatShare * motion.h / std::sqrt(share));
  }
  return longest;
}

PLIANT_INLINE void RestingContacts::add_followed(const std::vector<Contact>& resting, double max_gap,
                                                 std::vector<Contact>& found) const {
  for (const Contact& rested : resting) {
    const std::optional<Contact> contact = finder_.follow(rested);
    if (!contact || contact->gap > max_gap) continue;
    const auto [first, last] =
        std::equal_range(found.begin(), found.end(), *contact, ContactFinder::precedes);
    const double one_point = finder_.merge_distance(*contact);
    const bool is_new = std::none_of(
        first, last, [&](const Contact& other) { return (contact->x - other.x).norm() < one_point; });
    if (is_new) found.insert(last, *contact);
  }
}

PLIANT_INLINE std::vector<Contact> RestingContacts::contacts_after(const FreeMotion& motion,
                                                                   const std::vector<Contact>& resting,
                                                                   const State& state) const {
  double max_gap = resting.empty() ? 0 : gap();
  for (const Contact& contact : resting)
    max_gap = std::max({max_gap, gap() + resting_contacts::kLifts * contact.lift,
                        gap() + motion.force_time() * finder_.velocity(state, contact).dot(contact.normal)});
  const Pairs at_start(resting);
  auto rested = [&](const Contact& contact) {
    const double gap = this->gap(contact), size = smaller_size(model_, contact);
    const auto is_lasting = [&](const Contact& other) {
      const double distance = (contact.x - other.x).norm();
      if (!(other.lift > 0)) return contact.gap <= gap && distance <= resting_contacts::kSamePoint * size;
      return contact.gap <= gap + resting_contacts::kLifts * other.lift &&
             distance <= resting_contacts::kSamePredictedPoint * size &&
             contact.normal.dot(other.normal) >= resting_contacts::kSameNormals;
    };
    return at_start.has(contact, is_lasting) ||
           (at_start.has(contact) && was_resting(contact, motion, state));
  };
  std::vector<Contact> found = finder_.find(state, motion.end(), max_gap);
  add_followed(resting, max_gap, found);
  // force_time() is positive. Contacts that have not rested get the time zero.
  for (Contact& contact : found) contact.since = rested(contact) ? motion.force_time() : 0;
  found.erase(
      std::remove_if(found.begin(), found.end(), [](const Contact& c) { return c.since == 0 && c.gap > 0; }),
      found.end());
  return found;
}

}  // namespace pliant
