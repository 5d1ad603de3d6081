// The scene of a live simulation with the actions of the user.
#pragma once

#include <filesystem>
#include <string>

#include <pliant/view/live_simulation.h>

namespace pliant {

/// Returns the JSON text of the scene with the actions so far: each drag is a spring with the times `on` and
/// `off` and linear key frames; changed gravity, rest values and stiffnesses are linear key frames. `pliant
/// run` of this scene ends at the present time, has a frame at the end of each interval, and gives the same
/// bits of q and v there. folder: the folder of the saved scene; paths of meshes become relative to it.
/// scene_folder: the folder of the original scene.
std::string saved_scene(const LiveSimulation& simulation, const std::filesystem::path& scene_folder,
                        const std::filesystem::path& folder);

}  // namespace pliant
