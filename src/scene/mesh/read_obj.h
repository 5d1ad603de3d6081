// Reads Wavefront OBJ files: vertices (v) and faces (f). Other files that the text names are not opened.
#pragma once

#include "raw_mesh.h"

namespace pliant {

/// Returns the mesh of a file. Throws std::invalid_argument, with file, line and column, for a text that is
/// not OBJ.
RawMesh read_obj(const MeshBytes& file);

}  // namespace pliant
