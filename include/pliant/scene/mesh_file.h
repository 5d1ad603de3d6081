// Reads triangle meshes of obstacles from files: OBJ, PLY, STL, glTF.
#pragma once

#include <filesystem>
#include <string>

#include <Eigen/Core>

namespace pliant {

/// A mesh as stored in a file, with polygons split into triangles. Several vertices may have the same
/// position.
struct MeshFile {
  Eigen::Matrix3Xd vertices;   ///< in the units of the file, rounded to single precision
  Eigen::Matrix3Xi triangles;  ///< three column numbers of `vertices` per triangle
};

/// Reads all meshes of a file, each transformed by the nodes of the file that contain it (glTF). Throws
/// FileError if the file cannot be read and std::invalid_argument if it is not a mesh of triangles and
/// polygons with finite vertices. ObstacleMesh checks the topology of the result.
MeshFile read_mesh_file(const std::filesystem::path& file);

/// Returns the file name under which a run stores the mesh of an obstacle in its folder.
std::string recorded_mesh_name(const std::string& obstacle);
/// Returns whether a file name has the form of recorded_mesh_name().
bool is_recorded_mesh(const std::string& file_name);

}  // namespace pliant
