// The meshes of a run's frames as files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/scene/scene.h>

namespace pliant {

enum class MeshFormat { obj, ply };

/// Writes frame_000000.obj (with parts.mtl beside) or .ply for each of the frames, which are taken at number
/// / frame_rate seconds, into an existing folder. Where the scene has a coloring, PLY vertices carry its
/// values as "strain" or "displacement"; OBJ has no place for them. Throws std::system_error,
/// RecordingMismatch.
void write_mesh_frames(const std::filesystem::path& folder, MeshFormat format, const Scene& scene,
                       const Model& model, const Recording& recording, double frame_rate,
                       const std::vector<std::int64_t>& frames, Progress& progress);

}  // namespace pliant
