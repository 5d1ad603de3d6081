// Binary PLY files of a frame. Each vertex has the colour and the index of its mesh, and one normal: the
// normalised sum of the normals that its triangles have at this vertex. One normal per vertex keeps closed
// meshes closed. Planes and open obstacles have each triangle twice, once for each side: there the sum is
// zero, and the vertex gets the normal of its first triangle, which is on the front side.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pliant/io/frame_meshes.h>

namespace pliant {

/// Returns the bytes of a file: vertices x y z (double), nx ny nz (float), red green blue (uchar), part (int:
/// index of the mesh); then triangles. values: name of an additional property with the values of the vertices
/// (double); empty for none. If it is not empty, each mesh must have values.
std::string ply_bytes(const std::vector<NamedMesh>& meshes, const std::string& values = "");

/// Writes a PLY file (whole or absent, see whole_file.h). Throws std::system_error.
void write_ply(const std::filesystem::path& path, const std::vector<NamedMesh>& meshes,
               const std::string& values = "");

}  // namespace pliant
