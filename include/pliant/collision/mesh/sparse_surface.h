// The surface of a part as a mesh with few lines, for contact with parts that deform locally. A box gets
// few cells, the sides of a cylinder few cells along the axis, and a bent box many cells along the bend only.
#pragma once

#include <pliant/part/mesh/surface.h>

namespace pliant {

/// Returns the surface of a part at a resolution (Surface) without some of the mesh lines in flat regions.
/// The triangles cover the same surface at rest and at two other values of the dynamic parameters, up to
/// rounding. Along an axis of the frame, lines are left out only if the extent of the part at rest, divided
/// by the number of the remaining cells, is at most `cell` (m).
Surface sparse_surface(const Part& part, int resolution, double cell);

}  // namespace pliant
