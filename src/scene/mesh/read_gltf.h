// Reads glTF 2.0 files (.gltf and .glb): the triangles of all meshes of a scene, transformed by the nodes
// that contain them. Skins, morph targets and materials are ignored.
#pragma once

#include <filesystem>

#include "raw_mesh.h"

namespace pliant {

/// Returns the mesh of a file. folder: folder of the file, for its buffer files. Transformations are
/// evaluated in double precision. A transformation with a negative determinant reverses the order of the
/// corners, so that the outside of the mesh stays its outside. Throws std::invalid_argument, with the JSON
/// pointer of the fault, and FileError for a buffer file that cannot be read.
RawMesh read_gltf(const MeshBytes& file, const std::filesystem::path& folder);

}  // namespace pliant
