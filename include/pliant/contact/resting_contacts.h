// Resting contacts: surfaces that touch and do not separate.
#pragma once

#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/contact/free_motion.h>

namespace pliant {

class RestingContacts {
 public:
  /// model and finder must outlive this object.
  RestingContacts(const Model& model, const ContactFinder& finder);

  /// Widens the largest gap of resting contacts by `extra` (m), the opening that the residual of the last
  /// impulses may have caused.
  void widen_gap(double extra);
  /// Return the largest gap of a resting contact, m: for the pair of a contact, and for any pair.
  double gap(const Contact& contact) const { return widened(tight_gap(contact)); }
  double gap() const { return widened(gap_); }
  /// Returns gap(contact) without the extra gap, m.
  double tight_gap(const Contact& contact) const;
  /// Returns the contacts with a gap of at most gap() at a time t (s). If t and the sleeping parts are those
  /// of the last call and at most 70 % of the parts have moved since, only contacts of the moved parts are
  /// searched again. The reference is valid until the next call.
  const std::vector<Contact>& near(const State& state, double t);
  /// Returns the resting contacts among near(). A contact rests if it overlaps by more than gap(contact). It
  /// also rests if its gap is at most gap(contact) and its normal speed is at most motion.max_resting_speed.
  /// For smooth contacts (ContactFinder::is_smooth) without restitution, the largest speed is
  /// motion.max_inelastic_speed.
  std::vector<Contact> at_rest(const State& state, double t, const FreeMotion& motion);
  /// Returns the longest motion (s), at most motion.h, in which contacts that rest at the start sink by at
  /// most ContactFinder::max_resolved_depth, if no impulse acts. state: the end of the motion.
  double longest(const FreeMotion& motion, const std::vector<Contact>& resting, const State& state) const;
  /// Predicts the length of this longest motion (s) at the start of the motion, with gravity (m/s^2) as the
  /// only force.
  double longest(const FreeMotion& motion, const std::vector<Contact>& resting, double gravity) const;
  /// Adds contacts of `resting` to `found`, the result of the last call of ContactFinder::find(), at their
  /// places in the state of that call (ContactFinder::follow()). A contact is added if it is not in found and
  /// its gap is at most max_gap (m). This is needed if a part has turned: it then touches with one end of a
  /// nearly flat region only, although the other end rested, too. Keeps the order of found.
  void add_followed(const std::vector<Contact>& resting, double max_gap, std::vector<Contact>& found) const;
  /// Returns the contacts at `state`, the end of a motion: those that overlap, and those that rested at the
  /// start and are still near, because rounding, the motion or predicted impulses may have opened them.
  /// Contact::since of resting contacts is motion.force_time(): their impulses stand for forces during the
  /// whole motion.
  std::vector<Contact> contacts_after(const FreeMotion& motion, const std::vector<Contact>& resting,
                                      const State& state) const;

 private:
  double widened(double tight) const;
  bool few_moved(const State& state);
  double max_speed(const FreeMotion& motion, const Contact& contact) const;
  bool is_resting(const Contact& contact, double gap, double velocity, double max_speed) const;
  bool was_resting(const Contact& contact, const FreeMotion& motion, const State& state) const;

  const Model& model_;
  const ContactFinder& finder_;
  double gap_ = 0, extra_gap_ = 0;
  // The last search: its state and time, and its result.
  VecX<double> last_q_;
  std::vector<double> last_at_rest_;
  double last_t_ = 0;
  std::vector<Contact> last_;
  std::vector<bool> moved_;  // parts that have moved since the last search
};

}  // namespace pliant
