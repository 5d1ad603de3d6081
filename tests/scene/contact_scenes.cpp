// Contact in scene files: groups and pairs of things that collide, parts connected by joints, planes and
// plates that appear or disappear, and parts with a prescribed motion.
#include <cmath>
#include <memory>
#include <string>

#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"

namespace contact_scenes_test {

using pliant::Simulation;
using pliant::Vec3;

namespace {

/// A scene after a simulation until a given time (s), with rk4 and steps of 2 ms.
class FinishedRun {
 public:
  FinishedRun(const std::string& text, double until) {
    pliant::Diagnostics diagnostics;
    scene_ = pliant::parse_scene("s.json", text, {}, diagnostics);
    CHECK(diagnostics.text().empty());
    simulation_ = std::make_unique<Simulation>(scene_->body, "rk4");
    while (simulation_->time() < until - 1e-9) simulation_->step(2e-3);
  }
  Vec3<double> position(const std::string& part) const {
    return simulation_->model().position(simulation_->state(), scene_->body.index(*scene_->body.find(part)));
  }
  double height(const std::string& part) const { return position(part)[2]; }

 private:
  std::unique_ptr<pliant::Scene> scene_;
  std::unique_ptr<Simulation> simulation_;
};
std::string ball(const std::string& name, double x, double z) {
  return R"json({"name": ")json" + name +
         R"json(", "shape": "sphere", "parameters": {"r": 0.1}, "position": [)json" + std::to_string(x) +
         ", 0, " + std::to_string(z) + "]}";
}
/// Returns the distance (m) of a free fall during t seconds.
double fall_height(double t) {
  return 0.5 * 9.81 * t * t;
}

}  // namespace

TEST_CASE("groups and pairs of a scene determine the contacts", "[contact]") {
  // Columns of two balls: the lower ball touches the floor, and the gap between the two balls is 0.1 m. The
  // rules determine whether the balls collide with each other and with the floor.
  const std::string parts = "\"parts\": [" + ball("plain", 0, 0.1) + "," + ball("plain2", 0, 0.4) + "," +
                            ball("crumb", 1, 0.1) + "," + ball("crumb2", 1, 0.4) + "," +
                            ball("ghost", 2, 0.1) + "," + ball("ghost2", 2, 0.4) + "," + ball("odd", 3, 0.1) +
                            "," + ball("crumb3", 3, 0.4) + "]";
  const FinishedRun run("{" + parts + R"json(, "contact": {
    "planes": [{"name": "floor"}],
    "groups": {"crumbs": ["crumb", "crumb2", "crumb3"], "ghosts": ["ghost", "ghost2"], "ground": ["floor"]},
    "pairs": [{"between": ["crumbs", "crumbs"], "touch": false},
              {"between": ["ghosts", "ground"], "touch": false},
              {"between": ["ghost2", "floor"], "touch": true}]}})json",
                        0.6);
  CHECK(run.height("plain") == Approx(0.1).margin(1e-9));
  CHECK(run.height("plain2") == Approx(0.3).margin(1e-9));
  CHECK(run.height("crumb") == Approx(0.1).margin(1e-9));
  CHECK(run.height("crumb2") == Approx(0.1).margin(1e-9));
  CHECK(run.height("ghost") == Approx(0.1 - fall_height(0.6)).epsilon(1e-9));
  CHECK(run.height("ghost2") ==
        Approx(0.1).margin(1e-9));  // a rule for the part has precedence over a rule for its group
  CHECK(run.height("odd") == Approx(0.1).margin(1e-9));
  CHECK(run.height("crumb3") == Approx(0.3).margin(1e-9));
}

TEST_CASE("without contact between parts only named pairs collide", "[contact]") {
  const FinishedRun run("{\"parts\": [" + ball("a", 0, 0.1) + "," + ball("b", 0, 0.4) + "," +
                            ball("c", 1, 0.1) + "," + ball("d", 1, 0.4) +
                            R"json(], "contact": {"between_parts": false, "planes": [{"name": "floor"}],
                "pairs": [{"between": ["c", "d"]}]}})json",
                        0.6);
  CHECK(run.height("a") == Approx(0.1).margin(1e-9));
  CHECK(run.height("b") == Approx(0.1).margin(1e-9));
  CHECK(run.height("d") == Approx(0.3).margin(1e-9));
  const FinishedRun none("{\"parts\": [" + ball("a", 0, 0.1) + "," + ball("b", 0, 0.4) + "]}", 0.6);
  CHECK(none.height("a") == Approx(0.1 - fall_height(0.6)).epsilon(1e-9));
}

TEST_CASE("a pendulum passes through the post of its joint, unless a pair rule names both", "[contact]") {
  const auto swing = [](const std::string& contact) {
    return FinishedRun(R"json({"parts": [
      {"name": "post", "shape": "box", "parameters": {"a1": 0.05, "a2": 0.2, "a3": 0.5}, "position": [0, 0, -0.5], "fixed": true},
      {"name": "arm", "shape": "box", "parameters": {"a1": 0.02, "a2": 0.05, "a3": 0.2}, "position": [0.2, 0, 0.1],
       "orientation": {"axis": [0, 1, 0], "angle": 1.5707963267948966}}],
      "joints": [{"type": "hinge", "from": {"part": "arm", "at": {"u": -1.5707963267948966, "v": 0}},
                  "to": {"part": "post", "at": {"near": [0, 0, 0.6]}}, "axis": [0, 1, 0]}],
      "contact": )json" + contact +
                           "}",
                       0.6)
        .position("arm")[0];
  };
  CHECK(swing("{}") < -0.15);
  CHECK(swing(R"json({"pairs": [{"between": ["arm", "post"]}]})json") > 0.05);
}

TEST_CASE("planes and plates of a scene appear and disappear, and a prescribed motion carries a ball",
          "[contact]") {
  const FinishedRun run(
      "{\"parts\": [" + ball("a", 0, 0.1) + "," + ball("b", 5, 1) + "," + ball("c", 10, 0.6) + "," +
          R"json({"name": "lift", "shape": "box", "parameters": {"a1": 0.5, "a2": 0.5, "a3": 0.05},
                  "motion": {"position": [10, 0, "0.45 + 0.5 * t"]}}], "contact": {
      "planes": [{"name": "trap", "off": 0.2}],
      "obstacles": [{"name": "net", "half_extents": [0.5, 0.5], "position": [5, 0, 0.2], "on": 0.3}]}})json",
      0.6);
  CHECK(run.height("a") == Approx(0.1 - fall_height(0.4)).epsilon(1e-9));
  CHECK(run.height("b") == Approx(0.3).margin(1e-9));
  CHECK(run.height("c") == Approx(0.6 + 0.5 * 0.6).margin(1e-9));
}

}  // namespace contact_scenes_test
