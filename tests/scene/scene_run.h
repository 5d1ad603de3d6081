// Scenes from text, with their simulations and their messages.
#pragma once

#include <memory>
#include <string>

#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"

namespace pliant::test {

/// A scene without messages, with its simulation.
struct SceneRun {
  explicit SceneRun(const std::string& text, const std::string& method = "rk4", double tolerance = 0) {
    Diagnostics diagnostics;
    scene = parse_scene("s.json", text, {}, diagnostics);
    CHECK(diagnostics.text() == "");
    simulation = std::make_unique<Simulation>(scene->body, method, 1, tolerance);
  }
  double sensor(std::size_t k = 0) { return simulation->sensors()[static_cast<Eigen::Index>(k)]; }
  VecX<double> v_dot() const {
    Workspace<double> work;
    const State& state = simulation->state();
    simulation->dynamics().accelerations(state.time(), state.q, state.v, state, work);
    return work.v_dot;
  }
  std::unique_ptr<Scene> scene;
  std::unique_ptr<Simulation> simulation;
};

/// Returns the errors and warnings of a scene.
inline std::string messages_of(const std::string& text) {
  Diagnostics diagnostics;
  try {
    parse_scene("s.json", text, {}, diagnostics);
  } catch (const SceneError&) {
  }
  return diagnostics.text();
}

}  // namespace pliant::test
