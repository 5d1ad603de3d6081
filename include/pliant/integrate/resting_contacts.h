// Surfaces that lie on each other.
#pragma once

#include <vector>

#include <pliant/contact/find_contacts.h>

namespace pliant {

class RestingContacts {
 public:
  /// finder: must outlive it, as must its model.
  RestingContacts(const Model& model, const ContactFinder& finder);

  /// Surfaces that are nearer than this, and do not move apart, rest on each other, m: of this pair, and of
  /// the largest part.
  double gap(const Contact& contact) const;
  double gap() const { return gap_; }
  /// What lies near each other at time t (s), within gap().
  const std::vector<Contact>& near(const State& state, double t);
  /// Those of them that neither open nor strike by more than `slow` m/s.
  std::vector<Contact> at_rest(const State& state, double t, double slow);
  /// Whether a contact at the end of a step rested at its start, by how its sides have moved in between:
  /// faces that lie on each other may touch at other points of theirs. reach: of the method.
  bool rested(const Contact& contact, const State& before, const State& state, double reach,
              double slow) const;

 private:
  bool few_moved(const State& state);
  bool rests(const Contact& contact, double gap, double velocity, double slow) const;

  const Model& model_;
  const ContactFinder& finder_;
  double gap_ = 0;
  // Of the state that was looked at last.
  VecX<double> last_q_;
  std::vector<double> last_at_rest_;
  double last_t_ = 0;
  std::vector<Contact> last_;
  std::vector<bool> moved_;  // parts that are elsewhere now
};

}  // namespace pliant
