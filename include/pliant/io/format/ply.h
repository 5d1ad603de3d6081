// Binary PLY files of a frame: one closed mesh a part, with colours and the number of the part at every
// vertex. A vertex has one normal here (the mean of its corners'), so that meshes stay closed.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pliant/io/frame_meshes.h>

namespace pliant {

/// The bytes of a file: vertices x y z (double), nx ny nz (float), red green blue (uchar: of the part), part
/// (int); triangles. values: the name under which the values of the vertices follow (double), empty for none.
std::string ply_bytes(const std::vector<NamedMesh>& meshes, const std::string& values = "");

/// Writes a file (whole or absent). Throws std::system_error.
void write_ply(const std::filesystem::path& path, const std::vector<NamedMesh>& meshes,
               const std::string& values = "");

}  // namespace pliant
