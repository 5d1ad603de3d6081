// How far global deformations turn a part locally. The elasticity of displacements d in the part's frame is
// that of small turns: a quarter of a turn makes normal displacements tangential (design 1.3).
#pragma once

#include <pliant/part/local/local_deformation.h>

namespace pliant {

/// Beyond this turn, rad, elasticity that is linear in d means something else than at rest.
inline constexpr double kMostLinearTurn = 0.3;

/// Whether some of its elasticity is linear in d, and not alike to all directions, while parameters change
/// the shape under it.
bool linear_on_moving_shape(const Part& part);

/// The largest angle, rad, by which the shape of these parameters, d aside, turns a triangle of the surface
/// of the part's mesh in its frame against rest.
double largest_surface_turn(const Part& part, const VecMax<double>& q_s);

}  // namespace pliant
