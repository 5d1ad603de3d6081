// A contact: a point at which two surfaces touch, or nearly touch.
#pragma once

#include <array>

#include <pliant/shape/material.h>

namespace pliant {

/// One side of a contact: a material point of a part. For a part that deforms locally it is a point between
/// up to three nodes of its mesh; or the part as a whole, where the part is separated from another one that
/// it overlaps deeply.
struct ContactSide {
  int part = -1;                                ///< number of the part; -1 for a plane or an obstacle
  Material<double> material;                    ///< material point of the part
  std::array<int, 3> node{-1, -1, -1};          ///< nodes of the mesh instead of it; -1 marks an unused entry
  Vec3<double> weight = Vec3<double>::UnitX();  ///< weights of these nodes; their sum is 1

  bool at_nodes() const { return node[0] >= 0; }
};

struct Contact {
  ContactSide a, b;                            ///< side b may be a plane or an obstacle
  int plane = -1, obstacle = -1;               ///< number of that plane or obstacle
  Vec3<double> x = Vec3<double>::Zero();       ///< contact point, m, world
  Vec3<double> normal = Vec3<double>::Zero();  ///< unit vector from b to a, world
  double gap = 0;                              ///< m; negative: depth of the overlap
  /// Prescribed part of the velocity of side b relative to side a at x, m/s, world: the motion of a plane or
  /// of a part without coordinates.
  Vec3<double> carried = Vec3<double>::Zero();
  double friction = 0, restitution = 0;
  /// Time since the impulse of this contact acted, s. The positions of the pushed bodies change by this time
  /// multiplied by their change of velocity.
  double since = 0;
  /// Least normal velocity with which the sides separate after the impulse, m/s.
  double rebound = 0;
};

}  // namespace pliant
