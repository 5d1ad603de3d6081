// Resting contacts: surfaces that touch without moving apart or striking.
#pragma once

#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/contact/free_motion.h>

namespace pliant {

class RestingContacts {
 public:
  /// The model and the finder must outlive the object.
  RestingContacts(const Model& model, const ContactFinder& finder);

  /// Widens the gap of resting contacts by the displacement (m) that the residual of the last step allows.
  void loosen(double loose);
  /// Returns the gap below which surfaces that do not move apart rest on each other, m: of this pair, and of
  /// the largest part.
  double gap(const Contact& contact) const { return loosened(tight_gap(contact)); }
  double gap() const { return loosened(gap_); }
  /// Returns the gap of this pair without a residual, m.
  double tight_gap(const Contact& contact) const;
  /// Returns the contacts within gap() at time t, s.
  const std::vector<Contact>& near(const State& state, double t);
  /// Returns the near contacts whose normal speed is at most `slow`, m/s.
  std::vector<Contact> at_rest(const State& state, double t, double slow);
  /// Returns the longest motion, s, that has led to `state`, in which contacts at rest at its start sink in
  /// by at most ContactFinder::thin if nothing holds them.
  double longest(const FreeMotion& motion, const std::vector<Contact>& resting, const State& state) const;
  /// Returns its prediction before the motion, by gravity (m/s^2) alone.
  double longest(const FreeMotion& motion, const std::vector<Contact>& resting, double gravity) const;
  /// Returns the contacts at the end of a motion that has led to `state`: overlaps, and all near contacts of
  /// pairs that rested at its start, which rounding or the free motion may have separated. Contacts that
  /// rested have lasted for the whole motion (Contact::since).
  std::vector<Contact> met(const FreeMotion& motion, const std::vector<Contact>& resting,
                           const State& state) const;

 private:
  double loosened(double tight) const;
  bool few_moved(const State& state);
  bool rests(const Contact& contact, double gap, double velocity, double slow) const;
  bool rested(const Contact& contact, const FreeMotion& motion, const State& state) const;

  const Model& model_;
  const ContactFinder& finder_;
  double gap_ = 0, loose_ = 0;
  // The state of the last search.
  VecX<double> last_q_;
  std::vector<double> last_at_rest_;
  double last_t_ = 0;
  std::vector<Contact> last_;
  std::vector<bool> moved_;  // parts that have moved since then
};

}  // namespace pliant
