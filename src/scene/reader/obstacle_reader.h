// Reading obstacles: meshes from files, and plates.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pliant/scene/reader/reader.h>
#include <pliant/scene/scene.h>
#include <pliant/scene/schema/schema.h>

#include "scene/scene_faults.h"

namespace pliant {

/// Where the files are that a scene names.
struct MeshFolder {
  std::filesystem::path path;
  bool of_a_run = false;  ///< meshes are there under the names that a run gives them
};

schema::Record obstacle_record(const schema::Type& orientation, const schema::Type& color);

/// Adds an obstacle to the scene, unless there is a fault in it. taken: names of other things.
void read_obstacle(const Reader& r, const std::vector<std::string>& taken, const MeshFolder& folder,
                   SceneFaults& faults, Scene& scene);

}  // namespace pliant
