// A contact: two surfaces that meet at a point, or nearly do.
#pragma once

#include <pliant/shape/material.h>

namespace pliant {

/// The side of a contact that is on a part.
struct ContactSide {
  int part = -1;              ///< number of the part; -1: a plane or an obstacle
  Material<double> material;  ///< the point of it
};

struct Contact {
  ContactSide a, b;                             ///< b may be a plane or an obstacle
  int plane = -1, obstacle = -1;                ///< its number
  Vec3<double> x = Vec3<double>::Zero();        ///< where they meet, m, world
  Vec3<double> normal = Vec3<double>::Zero();   ///< from b to a, of length 1, world
  double gap = 0;                               ///< m; negative: so deep
  Vec3<double> carried = Vec3<double>::Zero();  ///< velocity of the plane there, m/s
  double friction = 0, restitution = 0;
};

}  // namespace pliant
