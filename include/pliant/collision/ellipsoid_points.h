// Where an ellipsoid comes nearest to a plane or to another ellipsoid, in closed form but for one root.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// The direction y, of length 1, of the point axes y that lies farthest against n.
Vec3<double> lowest_direction(const Vec3<double>& axes, const Vec3<double>& n);

/// The direction y, of length 1, for which the point M y + r is nearest to 0: with M = B^-1 R A and r = B^-1
/// d that of the point A y of an ellipsoid at which w of another is least, which has the semi-axes B and its
/// frame at distance d, R taking vectors into it. M: not singular.
Vec3<double> nearest_direction(const Mat3<double>& M, const Vec3<double>& r);

}  // namespace pliant
