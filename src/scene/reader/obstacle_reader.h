// Reading the obstacles of a scene: meshes from files, and plates.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pliant/scene/reader/reader.h>
#include <pliant/scene/scene.h>
#include <pliant/scene/schema/schema.h>

#include "scene/scene_faults.h"

namespace pliant {

/// The folder of the mesh files of a scene.
struct MeshFolder {
  std::filesystem::path path;
  bool of_a_run = false;  ///< whether the files have the names that a run gives them (recorded_mesh_name)
};

/// Returns the record of an obstacle. orientation, color: types of the keys of these names.
schema::Record obstacle_record(const schema::Type& orientation, const schema::Type& color);

/// Reads an obstacle and adds the obstacle to the scene. If it has faults, they are reported instead. taken:
/// names of parts, planes and other obstacles.
void read_obstacle(const Reader& r, const std::vector<std::string>& taken, const MeshFolder& folder,
                   SceneFaults& faults, Scene& scene);

}  // namespace pliant
