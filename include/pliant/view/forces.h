// The forces of a simulation, or at a state, as arrows.
#pragma once

#include <vector>

#include <pliant/simulate/simulation.h>

namespace pliant {

/// A force at a point, world.
struct ForceArrow {
  Vec3<double> at;     ///< m
  Vec3<double> force;  ///< N
};

/// The forces of each kind.
struct ForceArrows {
  std::vector<ForceArrow> contacts, joints, loads;
};

/// Which kinds of forces are shown.
struct ShownForces {
  bool contacts = false, joints = false, loads = false;
  bool any() const { return contacts || joints || loads; }
};

/// Returns the mean force of each contact of the last step. The force acts on side a of the contact.
std::vector<ForceArrow> contact_forces(const Simulation& simulation);
/// Returns the forces of the joints at the state, on their first parts, at the first points of the joints.
std::vector<ForceArrow> joint_forces(const Dynamics& dynamics, const State& state);
/// Returns the forces of springs, on the parts at their ends, and the forces at points. A distributed force
/// is one arrow: the sum of the forces at all its points, drawn at the mean of these points. The weights of
/// the mean are the norms of the forces.
std::vector<ForceArrow> load_forces(const Dynamics& dynamics, const State& state);

}  // namespace pliant
