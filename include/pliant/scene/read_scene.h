// Reading a scene: from a JSON document to a Scene with its MultiBody.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// File names of the meshes of obstacles: the names given in the scene, or the names under which a run stores
/// the meshes in its folder (recorded_mesh_name).
enum class MeshFiles { as_named, of_a_run };

/// Reads a scene file ("-" is standard input). overrides: assignments "/json/pointer=value", applied before
/// the scene is validated. diagnostics: receives the warnings and the errors. solver: the sparse
/// factorisation for joints and for modes of meshes; the scene replaces its `choice` between blocks and the
/// augmented matrix. Throws SceneError with all faults of the scene, FileError if the file cannot be read.
std::unique_ptr<Scene> read_scene(const std::string& file, const std::vector<std::string>& overrides,
                                  Diagnostics& diagnostics, const JointSolver& solver = {},
                                  MeshFiles files = MeshFiles::as_named);

/// Reads a scene from a text; `name` replaces the file name in messages, and paths of meshes are relative to
/// its folder. Throws what read_scene() throws.
std::unique_ptr<Scene> parse_scene(const std::string& name, std::string text,
                                   const std::vector<std::string>& overrides, Diagnostics& diagnostics);

}  // namespace pliant
