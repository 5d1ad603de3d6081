// The local rotation of the surface of a part by its global deformations. Elasticity that is linear in the
// local displacement d assumes that this rotation is small, because d has components in the frame of the
// part. For example, with a local rotation by 90 degrees a normal displacement would become tangential.
#pragma once

#include <pliant/part/local/local_deformation.h>

namespace pliant {

/// The largest local rotation, rad, for which elasticity that is linear in d is accurate.
inline constexpr double kMaxLinearRotation = 0.3;

/// Returns whether the part has dynamic parameters and an elastic law that is linear in d and depends on the
/// direction of d. The result is true for all parts that have dynamic parameters and modes.
bool linear_on_moving_shape(const Part& part);

/// Returns the largest angle (rad) by which a triangle of the surface of the local mesh rotates, in the frame
/// of the part and for d = 0, when q_s changes from rest to the given value. Triangles without area at rest
/// or at q_s are ignored. The part must have local deformation.
double largest_surface_turn(const Part& part, const VecMax<double>& q_s);

}  // namespace pliant
