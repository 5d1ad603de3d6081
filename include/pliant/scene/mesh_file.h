// Triangle meshes from files, for obstacles: OBJ, PLY, STL, glTF.
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>

namespace pliant {

/// A mesh as a file has it, polygons cut into triangles; several corners may be at one place.
struct MeshFile {
  Eigen::Matrix3Xd vertices;   ///< in the units of the file, single precision
  Eigen::Matrix3Xi triangles;  ///< columns of these
};

/// Reads all meshes of a file, placed as its nodes say. Throws FileError when it cannot be read,
/// std::invalid_argument when it is no mesh; ObstacleMesh tells whether the mesh is sound.
MeshFile read_mesh_file(const std::filesystem::path& file);

/// The name under which a run keeps the mesh of an obstacle beside its scene.
std::string recorded_mesh_name(const std::string& obstacle);
/// Whether a file has such a name.
bool is_recorded_mesh(const std::string& file_name);

}  // namespace pliant
