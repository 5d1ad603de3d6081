// The point of an ellipsoid that is nearest to a plane, in closed form, and the point that is nearest to
// another ellipsoid, in closed form except for one scalar root.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// Returns the unit vector y for which n . (axes y) is least, where axes y is the entry-by-entry product with
/// the semi-axes (m). n: a direction in the frame of the ellipsoid.
Vec3<double> lowest_direction(const Vec3<double>& axes, const Vec3<double>& n);

/// Returns the unit vector y for which |M y + r| is least. Two ellipsoids have semi-axes A and B (diagonal
/// matrices). With M = B^-1 R A and r = B^-1 d, A y is the point of the first ellipsoid at which the radial
/// material coordinate w of the second ellipsoid is least. R turns vectors of the first frame into the second
/// frame; d is the origin of the first frame in the second frame, m. M must not be singular.
Vec3<double> nearest_direction(const Mat3<double>& M, const Vec3<double>& r);

}  // namespace pliant
