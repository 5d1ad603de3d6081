// Writing the meshes of the frames of a run to files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include <pliant/io/recording.h>
#include <pliant/io/run/progress.h>
#include <pliant/scene/scene.h>

namespace pliant {

enum class MeshFormat { obj, ply };

/// Writes frame_000000.obj (and parts.mtl) or frame_000000.ply for each frame into an existing folder. Frame
/// k is at time k / frame_rate. If the scene has a coloring, PLY vertices have the values of the coloring as
/// the property "strain" or "displacement"; OBJ files cannot store values. Throws std::system_error,
/// RecordingMismatch. frames: numbers of the frames. The parameters are separate objects, because `pliant
/// run` (while the run is open) and `pliant export` (for a finished run) call this function.
void write_mesh_frames(const std::filesystem::path& folder, MeshFormat format, const Scene& scene,
                       const Model& model, const Recording& recording, double frame_rate,
                       const std::vector<std::int64_t>& frames, Progress& progress);

}  // namespace pliant
