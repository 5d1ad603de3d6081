// The options that select a scene: the scene file, and values of the scene set on the command line.
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
/// Reads the scene and prints its warnings on standard error. Throws pliant::SceneError if the scene has a
/// fault, and pliant::FileError if a file cannot be read.
std::unique_ptr<pliant::Scene> read(const SceneOptions& options);

/// Returns the solver of the joint equations. If SuiteSparse is linked into this program, the solver uses
/// CHOLMOD as factorisation and AMD for the order of the blocks, otherwise Eigen.
pliant::JointSolver solvers();

}  // namespace pliant_cli
