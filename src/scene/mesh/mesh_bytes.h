// Reads the bytes of a mesh file.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>

namespace pliant {

/// Largest size of a mesh file, and of all buffers of a glTF file together.
inline constexpr std::size_t kMaxMeshBytes = std::size_t{256} << 20;

/// Returns the bytes of a file. Throws FileError for a file that cannot be read, has more than kMaxMeshBytes,
/// or is not a regular file (a pipe or a device).
std::string read_mesh_bytes(const std::filesystem::path& file);

}  // namespace pliant
