// Reads PLY files, text and binary: x, y, z of the element vertex, and the list vertex_indices (or
// vertex_index) of the element face. The element tristrips is refused. Other elements and properties are
// ignored.
#pragma once

#include "raw_mesh.h"

namespace pliant {

/// Returns the mesh of a file. Throws std::invalid_argument, with line and column or byte, for bytes that are
/// not PLY.
RawMesh read_ply(const MeshBytes& file);

}  // namespace pliant
