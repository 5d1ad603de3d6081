// Imports mesh files of other formats with assimp: Collada, FBX, 3DS, OFF.
#pragma once

#include <array>
#include <filesystem>

#include "raw_mesh.h"

namespace pliant {

/// Endings of the file names that import_mesh() reads.
inline constexpr std::array<const char*, 4> kImportedEndings{".dae", ".fbx", ".3ds", ".off"};

/// Reads all meshes of a file, each transformed by the nodes that contain it, in single precision. assimp
/// runs in a separate process, with at most kImportSeconds of time and kImportBytes of memory, because
/// damaged files can crash assimp, or keep it busy for ever. Throws std::invalid_argument with the reason if
/// the file is not a mesh of triangles and polygons with finite vertices, if the import takes too long, or if
/// the import crashes. Throws FileError if the file cannot be read.
RawMesh import_mesh(const std::filesystem::path& file);

inline constexpr int kImportSeconds = 20;
inline constexpr std::size_t kImportBytes = std::size_t{4} << 30;

}  // namespace pliant
