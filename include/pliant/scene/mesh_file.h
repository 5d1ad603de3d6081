// Reads triangle meshes of obstacles from files: OBJ, PLY, STL, glTF, Collada, FBX, 3DS, OFF.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace pliant {

/// A mesh of triangles. Each position is one vertex, in the order of the file.
struct MeshFile {
  Eigen::Matrix3Xd vertices;       ///< in the units of the file; see read_mesh_file() for their precision
  Eigen::Matrix3Xi triangles;      ///< three column numbers of `vertices` per triangle
  std::vector<std::string> notes;  ///< flaws of the file that were removed, with their numbers, for the user
};

/// Reads all meshes of a file, each transformed by the nodes of the file that contain this mesh. Files .obj,
/// .ply, .stl, .gltf and .glb are read in double precision, files .dae, .fbx, .3ds and .off in single
/// precision. Polygons are divided into triangles, and common flaws are removed with a note
/// (src/scene/mesh/README.md). Memory is proportional to the size of the file. Throws FileError if the file
/// cannot be read, and std::invalid_argument, with the place of the fault, if it is not a mesh of triangles
/// and polygons with finite vertices. ObstacleMesh checks the topology of the result.
MeshFile read_mesh_file(const std::filesystem::path& file);
/// Reads a mesh from the bytes of a file; `name` is its path, whose ending chooses the format.
MeshFile read_mesh(const std::filesystem::path& name, std::string bytes);

/// Returns the file name under which a run stores the mesh of an obstacle in its folder.
std::string recorded_mesh_name(const std::string& obstacle);
/// Returns whether a file name has the form of recorded_mesh_name().
bool is_recorded_mesh(const std::string& file_name);

}  // namespace pliant
