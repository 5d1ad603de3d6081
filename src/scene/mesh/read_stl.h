// Reads STL files, text and binary. A binary file has a header of 80 bytes, the number n of triangles (4
// bytes), and 50 bytes for each triangle: normal, three corners, and two bytes without meaning. Normals are
// ignored; the order of the corners gives the orientation.
#pragma once

#include "raw_mesh.h"

namespace pliant {

/// Returns the mesh of a file. Throws std::invalid_argument, with the place, for bytes that are not STL.
RawMesh read_stl(const MeshBytes& file);

}  // namespace pliant
