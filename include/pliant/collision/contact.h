// A contact: two surfaces that meet at a point, or nearly do.
#pragma once

#include <array>

#include <pliant/shape/material.h>

namespace pliant {

/// The side of a contact that is on a part: a material point, or of a part that deforms locally a point
/// between up to three nodes of its mesh; or all of it, where it leaves another one that it is deep in.
struct ContactSide {
  int part = -1;                                ///< number of the part; -1: a plane or an obstacle
  Material<double> material;                    ///< the point of it
  std::array<int, 3> node{-1, -1, -1};          ///< or between these, as many as are not -1
  Vec3<double> weight = Vec3<double>::UnitX();  ///< with these, whose sum is 1

  bool at_nodes() const { return node[0] >= 0; }
};

struct Contact {
  ContactSide a, b;                            ///< b may be a plane or an obstacle
  int plane = -1, obstacle = -1;               ///< its number
  Vec3<double> x = Vec3<double>::Zero();       ///< where they meet, m, world
  Vec3<double> normal = Vec3<double>::Zero();  ///< from b to a, of length 1, world
  double gap = 0;                              ///< m; negative: so deep
  /// Velocity there of side b against side a as far as it is prescribed: of a plane, or a part without
  /// coordinates, m/s.
  Vec3<double> carried = Vec3<double>::Zero();
  double friction = 0, restitution = 0;
  /// What its impulse pushes moves by this times the change of velocity: how long ago it acted, s.
  double since = 0;
  /// Velocity at which the sides part after it, no less, m/s.
  double rebound = 0;
};

}  // namespace pliant
