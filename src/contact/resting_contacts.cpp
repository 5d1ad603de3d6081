#include <pliant/contact/resting_contacts.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include <pliant/math/index.h>

#include <pliant/contact/contact_pairs.h>

namespace pliant {

namespace {

/// Largest gap of resting contacts, in sizes of the smaller part.
constexpr double kResting = 1e-6;
/// Largest factor by which a residual widens this gap.
constexpr double kMostLoose = 1000;
/// If at most this share of the parts moved, only these are searched again.
constexpr double kFewParts = 0.7;
/// Points of the same contact at the start and the end of a step are within this distance, in sizes.
constexpr double kSamePoint = 0.2;
/// Motions that are too long are repeated with this share of the allowed displacement.
constexpr double kUnderThin = 0.95;

}  // namespace

RestingContacts::RestingContacts(const Model& model, const ContactFinder& finder)
    : model_(model), finder_(finder) {
  for (const PartModel& m : model.parts()) gap_ = std::max(gap_, kResting * m.part->size());
}

void RestingContacts::loosen(double loose) {
  if (loose != loose_) last_q_.resize(0);
  loose_ = loose;
}

double RestingContacts::loosened(double tight) const {
  return tight + std::min(loose_, kMostLoose * tight);
}

double RestingContacts::tight_gap(const Contact& contact) const {
  return kResting * smaller_size(model_, contact);
}

/// Marks the parts that have moved since the last search. Returns whether they are few.
bool RestingContacts::few_moved(const State& state) {
  moved_.assign(model_.parts().size(), false);
  int count = 0;
  for (int i = 0; i < static_cast<int>(model_.parts().size()); ++i) {
    const PartModel& m = model_.parts()[at(i)];
    if (m.q0 < 0 || state.q.segment(m.q0, m.n_q()) == last_q_.segment(m.q0, m.n_q())) continue;
    moved_[at(i)] = true;
    ++count;
  }
  return count <= kFewParts * static_cast<double>(model_.parts().size());
}

const std::vector<Contact>& RestingContacts::near(const State& state, double t) {
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
    const std::vector<Contact> kept = std::move(last_);
    last_.clear();
    std::merge(kept.begin(), kept.end(), found.begin(), found.end(), std::back_inserter(last_),
               ContactFinder::precedes);
  } else {
    last_ = finder_.find(state, t, gap());
  }
  last_q_ = state.q;
  last_at_rest_ = state.at_rest;
  last_t_ = t;
  return last_;
}

/// Returns whether surfaces with this gap and this relative normal velocity are at rest.
bool RestingContacts::rests(const Contact& contact, double gap, double velocity, double slow) const {
  const double near = this->gap(contact);
  return gap < -near || (gap <= near && std::abs(velocity) <= slow);
}

std::vector<Contact> RestingContacts::at_rest(const State& state, double t, double slow) {
  std::vector<Contact> resting = near(state, t);
  resting.erase(std::remove_if(resting.begin(), resting.end(),
                               [&](const Contact& c) {
                                 return !rests(c, c.gap, finder_.velocity(state, c).dot(c.normal), slow);
                               }),
                resting.end());
  return resting;
}

/// Returns whether a contact at the end of a motion was at rest at its start, by the relative motion of its
/// sides. Faces may touch at other points at the end.
bool RestingContacts::rested(const Contact& contact, const FreeMotion& motion, const State& state) const {
  const double u_start = finder_.velocity(motion.before, contact).dot(contact.normal),
               u = finder_.velocity(state, contact).dot(contact.normal),
               way = motion.h * ((1 - motion.reach) * u_start + motion.reach * u);
  return rests(contact, contact.gap - way, u_start, motion.loose);
}

double RestingContacts::longest(const FreeMotion& motion, const std::vector<Contact>& resting,
                                double gravity) const {
  double longest = motion.h;
  for (const Contact& contact : resting)
    longest = std::min(longest, kUnderThin * std::sqrt(finder_.thin(contact) / (motion.reach * gravity)));
  return longest;
}

double RestingContacts::longest(const FreeMotion& motion, const std::vector<Contact>& resting,
                                const State& state) const {
  double longest = motion.h;
  for (const Contact& contact : resting) {
    const Vec3<double> way = motion.h * ((1 - motion.reach) * finder_.velocity(motion.before, contact) +
                                         motion.reach * finder_.velocity(state, contact));
    const double share = std::abs(way.dot(contact.normal)) / finder_.thin(contact);
    if (share > 1) longest = std::min(longest, kUnderThin * motion.h / std::sqrt(share));
  }
  return longest;
}

std::vector<Contact> RestingContacts::met(const FreeMotion& motion, const std::vector<Contact>& resting,
                                          const State& state) const {
  double most = resting.empty() ? 0 : gap();
  for (const Contact& contact : resting)
    most = std::max(most, gap() + motion.held() * finder_.velocity(state, contact).dot(contact.normal));
  const Pairs rest(resting);
  auto lay = [&](const Contact& contact) {
    if (!rest.has(contact)) return false;
    if (contact.gap > 0 && contact.gap <= gap(contact)) return true;
    const double same = kSamePoint * smaller_size(model_, contact);
    return (contact.gap <= 0 &&
            rest.has(contact, [&](const Contact& other) { return (contact.x - other.x).norm() <= same; })) ||
           rested(contact, motion, state);
  };
  std::vector<Contact> contacts;
  for (Contact& contact : finder_.find(state, motion.end(), most)) {
    if (lay(contact))
      contact.since = motion.held();
    else if (contact.gap > 0)
      continue;
    contacts.push_back(contact);
  }
  return contacts;
}

}  // namespace pliant
