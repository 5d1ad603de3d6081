// Declaration of SCENE and --set, and reading of the scene.
#include "scene_options.h"

#include <iostream>

#include <pliant/scene/read_scene.h>
#ifdef PLIANT_HAS_SUITESPARSE
#include <pliant/solve/suitesparse.h>
#endif

namespace pliant_cli {

void add_scene_options(CLI::App& command, SceneOptions& options) {
  command.add_option("scene", options.file, "Scene file (JSON), or - for standard input")
      ->required()
      ->type_name("SCENE");
  command
      .add_option("--set", options.overrides,
                  "Set a value of the scene by its JSON pointer, for example /parts/0/density=500; may be "
                  "given several times")
      ->type_name("/POINTER=VALUE")
      ->take_all()
      ->allow_extra_args(false);
}

std::unique_ptr<pliant::Scene> read(const SceneOptions& options) {
  pliant::Diagnostics diagnostics;
  std::unique_ptr<pliant::Scene> scene =
      pliant::read_scene(options.file, options.overrides, diagnostics, solvers());
  if (diagnostics.warnings() > 0) std::cerr << diagnostics.text();
  return scene;
}

pliant::JointSolver solvers() {
  pliant::JointSolver solver;
#ifdef PLIANT_HAS_SUITESPARSE
  pliant::use_suitesparse(solver);
#endif
  return solver;
}

}  // namespace pliant_cli
