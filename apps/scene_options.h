// The options that say which scene is meant: the file and the values set on the command line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <pliant/scene/scene.h>

namespace pliant_cli {

struct SceneOptions {
  std::string file;
  std::vector<std::string> overrides;
};

/// Declares SCENE and --set.
void add_scene_options(CLI::App& command, SceneOptions& options);
/// Reads the scene; warnings go to standard error. Throws pliant::SceneError, pliant::FileError.
std::unique_ptr<pliant::Scene> read(const SceneOptions& options);

/// The solvers that are linked into this program.
pliant::JointSolver solvers();

}  // namespace pliant_cli
