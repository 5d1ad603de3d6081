// Surfaces that lie on each other.
#pragma once

#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/contact/free_motion.h>

namespace pliant {

class RestingContacts {
 public:
  /// finder: must outlive it, as must its model.
  RestingContacts(const Model& model, const ContactFinder& finder);

  /// What was left of the laws of contact may have parted what rests by so many m more than rounding.
  void loosen(double loose);
  /// Surfaces that are nearer than this, and do not move apart, rest on each other, m: of this pair, and of
  /// the largest part.
  double gap(const Contact& contact) const { return loosened(tight_gap(contact)); }
  double gap() const { return loosened(gap_); }
  /// Of this pair when nothing was left.
  double tight_gap(const Contact& contact) const;
  /// What lies near each other at time t (s), within gap().
  const std::vector<Contact>& near(const State& state, double t);
  /// Those of them that neither open nor strike by more than `slow` m/s.
  std::vector<Contact> at_rest(const State& state, double t, double slow);
  /// How long a motion may be, s, that has led to `state`, for what rested at its start to have sunk into
  /// each other, where nothing holds it, by no more than ContactFinder::thin.
  double longest(const FreeMotion& motion, const std::vector<Contact>& resting, const State& state) const;
  /// The same as far as it is foreseen before the motion: by gravity alone, m/s^2.
  double longest(const FreeMotion& motion, const std::vector<Contact>& resting, double gravity) const;
  /// What meets at the end of a motion, where it has led to `state`: sides that overlap, and of what rested
  /// on each other at its start all that is near, for rounding may have parted it, or the motion, in which
  /// nothing held it. What rested did so all along (Contact::since).
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
  // Of the state that was looked at last.
  VecX<double> last_q_;
  std::vector<double> last_at_rest_;
  double last_t_ = 0;
  std::vector<Contact> last_;
  std::vector<bool> moved_;  // parts that are elsewhere now
};

}  // namespace pliant
