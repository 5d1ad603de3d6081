// From a JSON document to a Scene.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/scene/diagnostics.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// Under which names the meshes of obstacles are beside a scene: those it says, or those a run gave them.
enum class MeshFiles { as_named, of_a_run };

/// Reads a scene file ("-" is standard input). overrides: "/json/pointer=value", applied before anything is
/// checked. Warnings are left in diagnostics. solver: of the joints, and of the modes of meshes (the scene
/// says which of its two ways is taken). Throws SceneError with all faults at once, FileError.
std::unique_ptr<Scene> read_scene(const std::string& file, const std::vector<std::string>& overrides,
                                  Diagnostics& diagnostics, const JointSolver& solver = {},
                                  MeshFiles files = MeshFiles::as_named);

/// The same for a text, `name` standing for the file in messages.
std::unique_ptr<Scene> parse_scene(const std::string& name, std::string text,
                                   const std::vector<std::string>& overrides, Diagnostics& diagnostics);

}  // namespace pliant
