// Removes common flaws of mesh files and reports them. The surface stays the same, except at slivers.
#pragma once

#include <pliant/scene/mesh_file.h>

#include "raw_mesh.h"

namespace pliant {

/// Returns the mesh with each position once (in the order of the file) and without
///   - vertices in no triangle, triangles with two equal corners, and second copies of triangles
///   - slivers: triangles whose height is at most 2 kNoHeight of their longest edge. The two vertices of a
///     short edge become one; otherwise the neighbouring triangle at the longest edge is divided
///   - walls between two solids: pairs of triangles with the same corners and opposite orientation that
///     belong to different surfaces.
/// Adds one note for each kind of flaw to the notes of the reader. Cleaning a clean mesh changes nothing.
MeshFile clean_mesh(RawMesh raw);

}  // namespace pliant
