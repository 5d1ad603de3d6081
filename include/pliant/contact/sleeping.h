// Sleep of bodies at rest (body/contact_settings.h): which bodies fall asleep after a step, and which bodies
// wake before a step. A sleeping part keeps its coordinates to the last bit, and its velocities are zero.
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
  /// All arguments must outlive this object. Throws std::invalid_argument for settings out of range.
  Sleeping(const Dynamics& dynamics, RestingContacts& resting, const MeshFinder& meshes);

  /// Begins a motion of h seconds from time t (s). Wakes sleeping parts that have a velocity, or for which a
  /// Drive (below) changes in the motion, and all parts that fell asleep together with them. Stores the
  /// coordinates if any part still sleeps.
  void begin_motion(double t, double h, State& state);
  /// Ends the motion: restores the coordinates of sleeping parts.
  void restore(State& state) const;
  /// Returns whether a sleeping part is at one of these contacts. Another body has then met this part,
  /// because contacts between sleeping parts are not searched.
  bool touches_sleeping(const std::vector<Contact>& contacts, const State& state) const;
  /// Wakes the parts at the contacts, and all parts that fell asleep together with them.
  void wake_touched(const std::vector<Contact>& contacts, State& state) const;
  /// Wakes sleeping parts whose coordinates or velocities impulses have changed since begin_motion().
  void wake_moved(State& state) const;
  /// Ends a step of h seconds from time t (s) with these contacts. Parts fall asleep if they, and all parts
  /// that they touch or are connected to, have been at rest for long enough. Connected parts stay awake if a
  /// Drive of one of them changes in the step, or if a part or plane with prescribed motion touches one of
  /// them. The velocities of parts that fall asleep become zero; Work::contact receives the change of energy.
  void fall_asleep(const std::vector<Contact>& contacts, double t, double h, State& state);

  /// Returns whether any part sleeps in this motion.
  bool any_asleep() const { return q_.size() > 0; }

 private:
  /// A cause that may move a sleeping part without contact.
  struct Drive {
    int part;                                         ///< -1: all parts
    std::function<bool(double t, double h)> changes;  ///< whether the cause changes within h seconds after t
  };

  void find_drives();
  void find_actuation();
  void find_switches();
  double speed(const State& state, int part) const;
  bool update_rest_times(double h, State& state) const;
  bool is_kinematic(const ContactSide& side, int plane) const;
  DisjointSets connected_parts(const std::vector<Contact>& contacts) const;

  const Dynamics& dynamics_;
  const Model& model_;
  RestingContacts& resting_;
  const MeshFinder& meshes_;
  const Sleep* settings_;    // nullptr: nothing sleeps
  std::vector<int> moving_;  // parts that have coordinates
  std::vector<Drive> drives_;
  VecX<double> q_;  // coordinates at the start of the motion; empty if nothing sleeps
};

}  // namespace pliant
