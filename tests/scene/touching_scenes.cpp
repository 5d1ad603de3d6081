// The scenes with contact from their beginning to their end, at their own step: at no step is a body deep in
// another, and what joints have closed stays closed through every blow.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/integrate/simulation.h>
#include <pliant/io/contact_notes.h>
#include <pliant/scene/read_scene.h>

#include "catch.h"

namespace touching_scenes_test {

namespace fs = std::filesystem;
using pliant::JointMode;
using pliant::Simulation;

namespace {

const std::vector<std::string> kRigid{"bowl", "dominoes", "slope", "tower"}, kSoft{"balloons", "springboard"},
    kJointed{"dragonfly", "snowman"};

/// Steps a scene to its end, and looks at every step how deep bodies are in each other. Returns how often a
/// body met another after 50 ms or more in which none touched any.
template <class AfterStep>
int run_to_the_end(const std::string& name, AfterStep&& after_step) {
  CAPTURE(name);
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::read_scene(std::string(PLIANT_SCENES) + "/" + name + ".json", {}, diagnostics);
  Simulation simulation(scene->body, scene->integrator, 1, scene->tolerance);
  REQUIRE(simulation.contact() != nullptr);
  int meetings = 0;
  double last = -1;
  while (simulation.time() < scene->end - 0.5 * scene->step) {
    simulation.step(scene->step);
    CAPTURE(simulation.time());
    REQUIRE(pliant::deepest_share(simulation) <= 1e-3);
    if (!simulation.contact()->contacts().empty()) {
      meetings += simulation.time() - last > 0.05;
      last = simulation.time();
    }
    after_step(simulation);
  }
  CHECK(simulation.time() == Approx(scene->end));
  return meetings;
}
void stay_apart(const std::vector<std::string>& names) {
  for (const std::string& name : names) CHECK(run_to_the_end(name, [](const Simulation&) {}) > 0);
}

}  // namespace

TEST_CASE("every scene with contact is run to its end") {
  std::vector<std::string> run = kRigid, with_contact;
  for (const std::vector<std::string>& more : {kSoft, kJointed})
    run.insert(run.end(), more.begin(), more.end());
  for (const fs::directory_entry& entry : fs::directory_iterator(PLIANT_SCENES)) {
    const fs::path& path = entry.path();
    if (path.extension() != ".json" || path.filename() == "pliant-scene.schema.json") continue;
    if (nlohmann::json::parse(std::ifstream(path)).contains("contact"))
      with_contact.push_back(path.stem().string());
  }
  std::sort(run.begin(), run.end());
  std::sort(with_contact.begin(), with_contact.end());
  CHECK(with_contact == run);
}

TEST_CASE("rigid bodies of the scenes are never deeper in each other than a thousandth of their size",
          "[contact][long]") {
  stay_apart(kRigid);
}

TEST_CASE("soft bodies of the scenes are never deeper in each other than a thousandth of their size",
          "[contact][long]") {
  stay_apart(kSoft);
}

TEST_CASE("joints of the dragonfly and the snowman that have closed stay closed through every blow",
          "[contact][joints][long]") {
  for (const std::string& name : kJointed) {
    std::vector<JointMode> modes;
    std::vector<bool> from_start, closed;
    const int meetings = run_to_the_end(name, [&](const Simulation& simulation) {
      modes = simulation.state().joints;
      closed.resize(modes.size());
      if (from_start.empty())
        for (const JointMode mode : modes) from_start.push_back(mode != JointMode::off);
      for (std::size_t j = 0; j < modes.size(); ++j) {
        closed[j] = modes[j] == JointMode::closed || (closed[j] && modes[j] != JointMode::off);
        if (!closed[j]) continue;
        INFO(simulation.model().joints()[j].joint->name());
        REQUIRE(modes[j] == JointMode::closed);
        // 1e-6 of a body length is asked for; 5e-14 m has been seen.
        REQUIRE(simulation.model().gap(simulation.state(), static_cast<int>(j)) <= 1e-12);
      }
    });
    CAPTURE(name, meetings);
    CHECK(meetings >= (name == "snowman" ? 6 : 1));
    CHECK(std::count(from_start.begin(), from_start.end(), true) >= (name == "snowman" ? 12 : 4));
    for (const JointMode mode : modes) CHECK(mode != JointMode::closing);
  }
}

}  // namespace touching_scenes_test
