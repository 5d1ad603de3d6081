// The options that select a scene: its file, and values set on the command line.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <pliant/scene/scene.h>

namespace pliant_cli {

struct SceneOptions {
  std::string file;                    ///< name of the scene file; "-" for standard input
  std::vector<std::string> overrides;  ///< the values of --set: "/json/pointer=value"
};

/// Declares the argument SCENE and the option --set.
void add_scene_options(CLI::App& command, SceneOptions& options);
/// Reads the scene and prints its warnings on standard error. Throws pliant::SceneError and
/// pliant::FileError.
std::unique_ptr<pliant::Scene> read(const SceneOptions& options);

/// Returns the solver of the joint equations: with CHOLMOD and its order of blocks if SuiteSparse is linked
/// into this program, otherwise with Eigen.
pliant::JointSolver solvers();

}  // namespace pliant_cli
