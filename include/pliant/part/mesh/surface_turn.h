// The local rotation of a part by its global deformations. Elasticity that is linear in d assumes that this
// rotation is small: d has components in the frame of the part, so that a local rotation by 90 degrees would
// make a normal displacement tangential.
#pragma once

#include <pliant/part/local/local_deformation.h>

namespace pliant {

/// The largest local rotation, rad, for which elasticity that is linear in d is accurate.
inline constexpr double kMaxLinearRotation = 0.3;

/// Returns whether dynamic parameters change the shape while an elastic law of the part is linear in d and
/// depends on the direction of d. The elasticity of modes is always such a law.
bool linear_on_moving_shape(const Part& part);

/// Returns the largest angle, rad, by which the reference shape at q_s rotates a triangle of the surface of
/// the mesh relative to rest, in the frame of the part and without d. Triangles without area are ignored. The
/// part must have local deformation.
double largest_surface_turn(const Part& part, const VecMax<double>& q_s);

}  // namespace pliant
