#include <pliant/integrate/resting_contacts.h>

#include <algorithm>
#include <cmath>

namespace pliant {

namespace {

/// How near surfaces that rest on each other are, in sizes of the smaller part.
constexpr double kResting = 1e-6;

}  // namespace

RestingContacts::RestingContacts(const Model& model, const ContactFinder& finder)
    : model_(model), finder_(finder) {
  for (const PartModel& m : model.parts()) gap_ = std::max(gap_, kResting * m.part->size());
}

double RestingContacts::gap(const Contact& contact) const {
  auto size = [&](int part) { return model_.parts()[static_cast<std::size_t>(part)].part->size(); };
  const double a = size(contact.a.part);
  return kResting * (contact.b.part < 0 ? a : std::min(a, size(contact.b.part)));
}

const std::vector<Contact>& RestingContacts::near(const State& state, double t) {
  if (last_q_.size() != state.q.size() || last_q_ != state.q || last_t_ != t ||
      !same_sleepers(last_at_rest_, state.at_rest)) {
    last_ = finder_.find(state, t, gap_);
    last_q_ = state.q;
    last_at_rest_ = state.at_rest;
    last_t_ = t;
  }
  return last_;
}

/// Whether surfaces with this gap between them and this velocity against each other rest there.
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

bool RestingContacts::rested(const Contact& contact, const State& before, const State& state, double reach,
                             double slow) const {
  const double u_start = finder_.velocity(before, contact).dot(contact.normal),
               u = finder_.velocity(state, contact).dot(contact.normal);
  return rests(contact, contact.gap - state.h * ((1 - reach) * u_start + reach * u), u_start, slow);
}

}  // namespace pliant
