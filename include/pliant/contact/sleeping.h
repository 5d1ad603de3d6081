// Sleep of bodies that have come to rest (contact_settings.h): which fall asleep after a step, and what wakes
// them before one. What sleeps keeps its coordinates to the last bit, and its velocities are zero.
#pragma once

#include <functional>
#include <vector>

#include <pliant/body/dynamics.h>
#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/resting_contacts.h>
#include <pliant/math/disjoint_sets.h>

namespace pliant {

class Sleeping {
 public:
  /// All must outlive it. Throws std::invalid_argument for settings out of range.
  Sleeping(const Dynamics& dynamics, RestingContacts& resting, const MeshFinder& meshes);

  /// Before a motion of h seconds from time t (s): those wake that have been given a velocity, or that
  /// something drives whose value changes by then, with all that sleep with them. What sleeps then is
  /// remembered.
  void begin_motion(double t, double h, State& state);
  /// After the motion: what sleeps is as it was.
  void restore(State& state) const;
  /// Whether a sleeper is met at some of these contacts, by what is awake or moved by hand.
  bool is_met(const std::vector<Contact>& contacts, const State& state) const;
  /// Those that are met wake, with all that sleep with them.
  void wake_met(const std::vector<Contact>& contacts, State& state) const;
  /// So do those that impulses have moved since.
  void wake_moved(State& state) const;
  /// After h seconds with these contacts, from time t (s) on: bodies that have been at rest for long enough,
  /// and all that they touch and are tied to, fall asleep. What kinetic energy they had is lost in contact.
  void fall_asleep(const std::vector<Contact>& contacts, double t, double h, State& state);

  /// Whether anything sleeps in this motion.
  bool any() const { return q_.size() > 0; }

 private:
  /// What may move a part, and with it its island, though nothing meets it.
  struct Drive {
    int part;                                         ///< -1: all
    std::function<bool(double t, double h)> changes;  ///< within h seconds of t
  };

  void note_drives();
  void note_switches();
  double speed(const State& state, int part) const;
  bool note_rest(double h, State& state) const;
  bool is_moved_by_hand(const ContactSide& side, int plane) const;
  DisjointSets sets_of(const std::vector<Contact>& contacts) const;

  const Dynamics& dynamics_;
  const Model& model_;
  RestingContacts& resting_;
  const MeshFinder& meshes_;
  const Sleep* settings_;    // nullptr: nothing sleeps
  std::vector<int> moving_;  // parts that have coordinates
  std::vector<Drive> drives_;
  VecX<double> q_;  // what was remembered; empty: nothing sleeps
};

}  // namespace pliant
