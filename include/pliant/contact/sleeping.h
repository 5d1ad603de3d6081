// Sleeping of bodies at rest (body/contact_settings.h): which bodies fall asleep after a step, and what wakes
// them before one. A sleeping body keeps its coordinates to the last bit, and its velocities are zero.
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
  /// All arguments must outlive the object. Throws std::invalid_argument for settings out of range.
  Sleeping(const Dynamics& dynamics, RestingContacts& resting, const MeshFinder& meshes);

  /// Wakes bodies before a motion of h seconds from time t (s): those that have a velocity, or a cause of
  /// motion that changes by then, with all that sleep with them. Stores the coordinates of those that sleep.
  void begin_motion(double t, double h, State& state);
  /// Restores the sleeping bodies after the motion.
  void restore(State& state) const;
  /// Returns whether a contact touches a sleeping body.
  bool is_met(const std::vector<Contact>& contacts, const State& state) const;
  /// Wakes the touched bodies, with all that sleep with them.
  void wake_met(const std::vector<Contact>& contacts, State& state) const;
  /// Wakes the bodies that impulses have moved.
  void wake_moved(State& state) const;
  /// Lets bodies fall asleep after h seconds from time t (s) with these contacts: those that have been at
  /// rest for long enough, together with all that they touch and are tied to. The kinetic energy that they
  /// had is lost in contact.
  void fall_asleep(const std::vector<Contact>& contacts, double t, double h, State& state);

  /// Returns whether any body sleeps in this motion.
  bool any() const { return q_.size() > 0; }

 private:
  /// A cause that may move a part, and its island, without a contact.
  struct Drive {
    int part;                                         ///< -1: all parts
    std::function<bool(double t, double h)> changes;  ///< whether its value changes within h seconds of t
  };

  void note_drives();
  void note_switches();
  double speed(const State& state, int part) const;
  bool note_rest(double h, State& state) const;
  bool is_kinematic(const ContactSide& side, int plane) const;
  DisjointSets sets_of(const std::vector<Contact>& contacts) const;

  const Dynamics& dynamics_;
  const Model& model_;
  RestingContacts& resting_;
  const MeshFinder& meshes_;
  const Sleep* settings_;    // nullptr: bodies do not sleep
  std::vector<int> moving_;  // parts that have coordinates
  std::vector<Drive> drives_;
  VecX<double> q_;  // coordinates of sleeping bodies; empty: none sleeps
};

}  // namespace pliant
