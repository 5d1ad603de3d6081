// A contact: two surfaces that meet at a point, or nearly do.
#pragma once

#include <pliant/shape/material.h>

namespace pliant {

/// The side of a contact that is on a part.
struct ContactSide {
  int part = -1;              ///< number of the part; -1: a plane
  Material<double> material;  ///< the point of it
};

struct Contact {
  ContactSide a, b;                            ///< b may be a plane
  int plane = -1;                              ///< its number
  Vec3<double> x = Vec3<double>::Zero();       ///< where they meet, m, world
  Vec3<double> normal = Vec3<double>::Zero();  ///< from b to a, of length 1, world
  double gap = 0;                              ///< m; negative: so deep
  /// Velocity there of side b against side a as far as it is prescribed: of a plane, or a part without
  /// coordinates, m/s.
  Vec3<double> carried = Vec3<double>::Zero();
  double friction = 0, restitution = 0;
};

}  // namespace pliant
