// The mesh of a shell on its parameter rectangle (u, v). Terzopoulos & Metaxas 1991 define the loaded
// membrane over this rectangle.
#pragma once

#include <pliant/local/shell/loaded_membrane.h>
#include <pliant/part/local/local_mesh.h>

namespace pliant {

/// Returns u and v (rad) at the corners of the triangles of a shell. Angles of a triangle that crosses the
/// seam continue beyond pi. A triangle with a corner at a pole becomes two triangles, so that all triangles
/// cover the rectangle once. Throws std::invalid_argument if a triangle has no area on the rectangle.
ParameterMesh parameter_mesh(const LocalMesh& mesh);

}  // namespace pliant
