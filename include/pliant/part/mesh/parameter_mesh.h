// The mesh of a shell on its parameter rectangle (u, v). Terzopoulos & Metaxas 1991 define the loaded
// membrane over this rectangle.
#pragma once

#include <pliant/local/shell/loaded_membrane.h>
#include <pliant/part/local/local_mesh.h>

namespace pliant {

/// Returns the triangles of a shell with u and v (rad) at their corners. The angles of a triangle that
/// crosses the seam are not confined to [-pi, pi]. A triangle with a corner at a pole becomes two triangles,
/// so that all triangles together cover the rectangle once. Throws std::invalid_argument if the area of a
/// triangle on the rectangle is not positive.
ParameterMesh parameter_mesh(const LocalMesh& mesh);

}  // namespace pliant
