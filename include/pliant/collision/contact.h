// A contact: a point at which two surfaces touch, or nearly touch.
#pragma once

#include <array>

#include <pliant/shape/material.h>

namespace pliant {

/// One side of a contact: a material point of a part, or a plane or obstacle. If the part deforms locally,
/// the side is a point between up to three nodes of its mesh. In a deep overlap of two parts the contact acts
/// on each part as a whole; the side then has no nodes. The material point is set if the velocity of the side
/// depends on it.
struct ContactSide {
  int part = -1;                                ///< number of the part; -1 for a plane or an obstacle
  Material<double> material;                    ///< material point of the part; not used if at_nodes()
  std::array<int, 3> node{-1, -1, -1};          ///< mesh nodes that define the point; -1: unused entry
  Vec3<double> weight = Vec3<double>::UnitX();  ///< weights of the mesh nodes; their sum is 1

  bool at_nodes() const { return node[0] >= 0; }
};

struct Contact {
  ContactSide a, b;                            ///< side b may be a plane or an obstacle
  int plane = -1, obstacle = -1;               ///< number of the plane or obstacle of side b; -1: none
  Vec3<double> x = Vec3<double>::Zero();       ///< contact point, m, world
  Vec3<double> normal = Vec3<double>::Zero();  ///< unit vector from b to a, world
  double gap = 0;                              ///< m; negative: depth of the overlap
  /// Prescribed contribution to the velocity of side b relative to side a at x, m/s, world. It comes from the
  /// motion of a plane or of a part with prescribed motion.
  Vec3<double> prescribed_velocity = Vec3<double>::Zero();
  double friction = 0, restitution = 0;  ///< coefficients of the pair
  /// Time since the impulse of this contact acted, s. The impulse changes the positions of the pushed parts
  /// by this time multiplied by the change of their velocities.
  double since = 0;
  /// Least normal velocity with which the sides separate after the impulse, m/s.
  double rebound = 0;
  /// Impulse that has acted on side a at the start of the motion, N s, world (contact/predicted_impulses.h).
  /// A motion is one step of the method of integration without contact impulses.
  Vec3<double> predicted = Vec3<double>::Zero();
  /// Distance by which `predicted` alone moves the sides apart during the motion, m.
  double lift = 0;
};

}  // namespace pliant
