// The mesh of a shell on its parameter rectangle (u, v), over which the loaded membrane was published.
#pragma once

#include <pliant/local/shell/loaded_membrane.h>
#include <pliant/part/local/local_mesh.h>

namespace pliant {

/// u and v (rad) at the corners of the triangles of a shell. Angles that close go on beyond pi where a
/// triangle crosses the seam; a triangle with a corner at a pole becomes two, so that all cover the rectangle
/// once. Throws std::invalid_argument where they do not, because nodes are closer together than angles tell.
ParameterMesh parameter_mesh(const LocalMesh& mesh);

}  // namespace pliant
