// The program and the JSON Schema accept all scenes in scenes/. The schema refuses every bad scene whose
// error concerns only types, keys or ranges. Some scenes move as expected.
// I59 and N36 in names of tests are rows of the tables in tests/README.md.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include <nlohmann/json.hpp>

#include <pliant/io/frame_schedule.h>
#include <pliant/scene/read_scene.h>
#include <pliant/scene/schema/scene_schema.h>
#include <pliant/scene/schema/schema.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"
#include "motion.h"
#include "schema_judge.h"

namespace scenes_test {

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> scenes_in(const fs::path& folder) {
  std::vector<fs::path> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".json" && entry.path().filename() != "pliant-scene.schema.json")
      all.push_back(entry.path());
  }
  std::sort(all.begin(), all.end());
  return all;
}

/// Returns a file as a JSON value. Its is_discarded() is true if the file is not JSON.
nlohmann::json json_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return nlohmann::json::parse(file, nullptr, false);
}

const pliant::test::SchemaValidator& schema() {
  static const pliant::test::SchemaValidator judge(pliant::schema::schema_json(pliant::scene_record()));
  return judge;
}

}  // namespace

TEST_CASE("every scene of the distribution reads without a warning, and can run", "[long]") {
  const std::vector<fs::path> scenes = scenes_in(PLIANT_SCENES);
  CHECK(scenes.size() >= 19);
  for (const fs::path& path : scenes) {
    INFO(path.filename().string());
    pliant::Diagnostics diagnostics;
    const auto scene = pliant::read_scene(path.string(), {}, diagnostics);
    CHECK(diagnostics.text().empty());
    CHECK_FALSE(scene->description.empty());
    CHECK_FALSE(scene->body.parts().empty());
    CHECK(pliant::FrameSchedule(scene->end, scene->step, scene->frame_rate).frames() > 1);
    const pliant::Simulation simulation(scene->body, scene->integrator);
    CHECK(simulation.model().parts().size() == scene->body.parts().size());
    CHECK(schema().accepts(json_of(path)));
  }
}

namespace {

using pliant::kPi;
using pliant::material_at;
using pliant::Simulation;
using pliant::Vec3;

/// Simulates a scene of scenes/ until a time (s), and calls after_step(simulation, ledger) after each step.
/// After each step the error of the energy balance must be below `max_balance` times the larger of 1 J and
/// the largest kinetic energy so far.
template <class AfterStep>
void run(const char* name, double until, double max_balance, AfterStep&& after_step) {
  INFO(name);
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::read_scene(std::string(PLIANT_SCENES) + "/" + name, {}, diagnostics);
  Simulation simulation(scene->body, scene->integrator);
  double largest = 0;
  while (simulation.time() < until) {
    simulation.step(scene->step);
    const pliant::Ledger ledger = simulation.ledger();
    largest = std::max(largest, ledger.kinetic);
    REQUIRE(std::abs(ledger.balance) < max_balance * std::max(largest, 1.0));
    after_step(simulation, ledger);
  }
}

/// Returns the world position of a material point of the first part.
Vec3<double> world_position(const Simulation& simulation, const pliant::Material<double>& m) {
  return simulation.model().world_point(simulation.state(), 0, m);
}
/// Returns the mean width (m) of the first part at a latitude u (rad): the mean of four diameters.
double width(const Simulation& simulation, double u) {
  double sum = 0;
  for (int i = 0; i < 4; ++i)
    sum += (world_position(simulation, material_at(u, kPi * i / 4)) -
            world_position(simulation, material_at(u, kPi * i / 4 + kPi)))
               .norm();
  return sum / 4;
}

}  // namespace

TEST_CASE(
    "the twisting tube untwists and twists the other way, the soft chain stretches, and both ledgers balance",
    "[long]") {
  double smallest = 0;
  run("twisting_tube.json", 0.8, 1e-5, [&](const Simulation& simulation, const pliant::Ledger&) {
    smallest = std::min(smallest, simulation.state().q[7]);
  });
  CHECK(smallest < -2);  // the initial value is 2.5
  double longest = 0;
  run("soft_chain.json", 0.7, 1e-5, [&](const Simulation& simulation, const pliant::Ledger&) {
    REQUIRE(simulation.model().gap(simulation.state(), 3) < 1e-12);
    longest = std::max(longest, (world_position(simulation, material_at(kPi / 2, 0)) -
                                 world_position(simulation, material_at(-kPi / 2, 0)))
                                    .norm());
  });
  CHECK(longest > 1.2 * 0.32);
}

TEST_CASE("the ringing sphere: its dents spring out and back, it rotates, momentum and energy are conserved",
          "[long]") {
  std::optional<pliant::Ledger> start;
  double out = 0, in = 1, smallest = 1, largest = 0, rotation_angle = 0;
  run("ringing_sphere.json", 0.45, 1e-3, [&](const Simulation& simulation, const pliant::Ledger& ledger) {
    if (!start) start = ledger;
    REQUIRE((ledger.momentum - start->momentum).norm() < 1e-11 * start->momentum.norm());
    REQUIRE((ledger.angular_momentum - start->angular_momentum).norm() <
            1e-9 * start->angular_momentum.norm());
    REQUIRE(std::abs(ledger.energy() - start->energy()) < 3e-4 * ledger.kinetic);
    smallest = std::min(smallest, ledger.kinetic);
    largest = std::max(largest, ledger.kinetic);
    const double dent =
        (world_position(simulation, material_at(0, 0)) - simulation.state().q.head<3>()).norm();
    out = std::max(out, dent);
    if (out > 0.55) in = std::min(in, dent);
    rotation_angle = 2 * std::acos(std::abs(simulation.state().q[3]));
  });
  CHECK(out > 0.55);  // initially 0.38; the radius of the undented sphere is 0.5
  CHECK(in < 0.53);
  CHECK(largest > 1.2 * smallest);
  CHECK(rotation_angle == Approx(0.45 * std::sqrt(1.2)).epsilon(0.1));
}

TEST_CASE("the balloon falls until its slack string is tight, stretches at its knot, and bulges below",
          "[long]") {
  bool slack = false;
  double largest_stretch = 0, above = 0, below = 0;
  run("balloon.json", 0.6, 1e-4, [&](const Simulation& simulation, const pliant::Ledger&) {
    const Vec3<double> knot = world_position(simulation, material_at(kPi / 2, 0));
    REQUIRE(knot.norm() <= 0.5 + 1e-12);
    slack = slack || knot.norm() < 0.4;
    const double stretch = (knot - simulation.state().q.head<3>()).norm();
    if (stretch <= largest_stretch) return;
    largest_stretch = stretch;
    above = width(simulation, 0.7);
    below = width(simulation, -0.7);
  });
  CHECK(slack);
  CHECK(largest_stretch > 2 * 0.36);
  CHECK(below > 1.05 * above);
}

TEST_CASE("the rubber bar bends to one side and to the other, and rotates", "[long]") {
  double largest = 0, smallest = 0;
  Vec3<double> along = Vec3<double>::UnitZ();
  std::optional<pliant::Ledger> start;
  run("beam.json", 0.22, 5e-3, [&](const Simulation& simulation, const pliant::Ledger& ledger) {
    if (!start) start = ledger;
    REQUIRE((ledger.momentum - start->momentum).norm() < 1e-11 * start->momentum.norm());
    REQUIRE((ledger.angular_momentum - start->angular_momentum).norm() <
            1e-6 * start->angular_momentum.norm());
    const Vec3<double> top = world_position(simulation, material_at(kPi / 2, 0)),
                       foot = world_position(simulation, material_at(-kPi / 2, 0));
    const double sag = (world_position(simulation, material_at(0, 0, 0)) - (top + foot) / 2)[0];
    largest = std::max(largest, sag);
    smallest = std::min(smallest, sag);
    along = (top - foot).normalized();
  });
  CHECK(largest > 0.15);
  CHECK(smallest < -0.15);
  CHECK(along[1] > 0.4);  // initially 0
  CHECK(std::abs(along[0]) < 0.01);
}

TEST_CASE("a spring pulls the membrane of a shell outwards, and its parameters adapt", "[long]") {
  double pulled_x = 0, local = 0, a1 = 0, others = 0;
  run("soft_pull.json", 0.3, 1e-5, [&](const Simulation& simulation, const pliant::Ledger&) {
    const pliant::State& state = simulation.state();
    const double x = world_position(simulation, material_at(0, 0))[0];
    pulled_x = std::max(pulled_x, x);
    local = std::max(local, x - state.q[0] - state.q[7]);
    a1 = std::max(a1, state.q[7]);
    others = std::max({others, std::abs(state.q[8] - 0.4), std::abs(state.q[9] - 0.6)});
  });
  CHECK(pulled_x > 0.8);  // initially 0.4
  CHECK(local > 0.35);
  CHECK(a1 > 1.05 * 0.4);
  CHECK(others < 0.2 * (a1 - 0.4));
}

TEST_CASE("the density of a shell is per volume if it has a thickness, otherwise per area") {
  const auto mass = [](const std::string& members) {
    pliant::Diagnostics diagnostics;
    const auto scene = pliant::parse_scene(
        "s.json",
        R"json({"parts": [{"name": "a", "shape": "sphere", "parameters": {"r": 0.3}, "density": 1100)json" +
            members + "}]}",
        {}, diagnostics);
    CHECK(diagnostics.text().empty());
    const pliant::Part& part = *scene->body.parts()[0];
    if (part.local() != nullptr)
      CHECK(part.local()->mesh().mass.sum() == Approx(part.total_mass()).epsilon(1e-12));
    return part.total_mass();
  };
  const double area = 4 * kPi * 0.3 * 0.3;
  const std::string local =
      R"json(, "local": {"resolution": 3, "laws": [{"type": "membrane", "E": 1e5, "thickness": 0.002}]})json";
  for (const std::string& more : {std::string(), local}) {
    CHECK(mass(R"json(, "shell": true, "thickness": 0.002)json" + more) ==
          Approx(1100 * 0.002 * area).epsilon(1e-12));
    CHECK(mass(R"json(, "shell": true)json" + more) == Approx(1100 * area).epsilon(1e-12));
  }
  CHECK(mass("") == Approx(1100 * area * 0.1).epsilon(1e-12));
}

TEST_CASE("the assembly report states whether shapes converged within the maximum number of iterations") {
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::read_scene(std::string(PLIANT_SCENES) + "/garland.json", {}, diagnostics);
  const pliant::AssemblyReport report = pliant::Simulation(scene->body, scene->integrator).assembly();
  CHECK(report.gap <= 1e-3);
  CHECK(report.converged == (report.iterations < 400));
}

TEST_CASE("N36: the dragonfly and the snowman assemble themselves, and closed joints stay closed", "[long]") {
  struct Case {
    const char* name;
    std::size_t joints;
    double until;  // time at which the assembly is complete, s
  };
  for (const Case& c : {Case{"dragonfly.json", 4, 3.3}, Case{"snowman.json", 12, 3.1}}) {
    INFO(c.name);
    pliant::Diagnostics diagnostics;
    const auto scene = pliant::read_scene(std::string(PLIANT_SCENES) + "/" + c.name, {}, diagnostics);
    pliant::Simulation simulation(scene->body, scene->integrator);
    const pliant::Model& model = simulation.model();
    std::vector<std::size_t> assembled;  // joints that are active from the start
    for (std::size_t j = 0; j < model.joints().size(); ++j) {
      if (simulation.state().joints[j] == pliant::JointMode::off) continue;
      assembled.push_back(j);
      CHECK(simulation.state().joints[j] == pliant::JointMode::closing);
      CHECK(model.gap(simulation.state(), static_cast<int>(j)) > 0.5);
    }
    CHECK(assembled.size() == c.joints);
    std::vector<bool> closed(model.joints().size());
    while (simulation.time() < c.until) {
      simulation.step(scene->step);
      for (const std::size_t j : assembled) {
        if (simulation.state().joints[j] == pliant::JointMode::closed) closed[j] = true;
        if (!closed[j]) continue;
        REQUIRE(simulation.state().joints[j] == pliant::JointMode::closed);
        REQUIRE(model.gap(simulation.state(), static_cast<int>(j)) <= 1e-12);
      }
    }
    for (const std::size_t j : assembled) {
      INFO(model.joints()[j].joint->name());
      CHECK(closed[j]);
    }
  }
}

TEST_CASE("a scene without an integrator uses auto, or the method of the paper if it gives a step") {
  const auto scene_with = [](const std::string& time) {
    pliant::Diagnostics diagnostics;
    auto scene = pliant::parse_scene("s.json", "{\"parts\": [], \"time\": " + time + "}", {}, diagnostics);
    CHECK(diagnostics.text().empty());
    return scene;
  };
  for (const char* time : {"{}", "{\"end\": 2}"}) {
    const auto scene = scene_with(time);
    CHECK(scene->integrator == pliant::kAutomatic);
    CHECK(scene->tolerance == pliant::kStandardTolerance);
  }
  CHECK(scene_with("{\"tolerance\": 1e-4}")->integrator == pliant::kAutomatic);
  const auto stepped = scene_with("{\"step\": 0.01}");
  CHECK(stepped->integrator == pliant::kFixedStepIntegrator);
  CHECK(stepped->tolerance == 0);
  CHECK(scene_with("{\"integrator\": \"rk4\"}")->tolerance == 0);
}

TEST_CASE("a tumbling bat keeps its energy with the default settings") {
  // Dzhanibekov's effect: the bat spins about its middle axis and flips every 4.7192 s.
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::parse_scene("bat.json", R"json({
    "gravity": [0, 0, 0], "time": {"end": 60},
    "parts": [{"name": "bat", "shape": "box", "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.05},
               "angular_velocity": [0.02, 5, 0]}]})json",
                                         {}, diagnostics);
  pliant::Simulation simulation(scene->body, scene->integrator, 1, scene->tolerance);
  const double start = simulation.ledger().energy();
  int flips = 0;
  double last = 5;
  while (simulation.time() < scene->end) {
    simulation.step_up_to(scene->end);
    const double now = simulation.state().v[4];
    flips += std::abs(now) > 1 && now * last < 0 ? 1 : 0;
    if (std::abs(now) > 1) last = now;
  }
  CHECK(flips == 13);
  CHECK(simulation.ledger().energy() == Approx(start).epsilon(1e-5));
}

TEST_CASE("I59: a scene without parts, and a scene that ends at time 0, are read") {
  for (const char* text : {"{\"parts\": []}", "{\"parts\": [], \"time\": {\"end\": 0}}"}) {
    pliant::Diagnostics diagnostics;
    const auto scene = pliant::parse_scene("s.json", text, {}, diagnostics);
    CHECK(diagnostics.text().empty());
    CHECK(pliant::FrameSchedule(scene->end, scene->step, scene->frame_rate).frames() >= 1);
    const pliant::Simulation simulation(scene->body, scene->integrator);
    CHECK(simulation.model().n_v() == 0);
    CHECK(schema().accepts(nlohmann::json::parse(text)));
  }
}

TEST_CASE("comments and extensions are allowed everywhere, and ignored") {
  const std::string text = R"json({
    "//": "a ball", "//": ["twice"], "x-editor": {"zoom": 2},
    "materials": {"//": "one", "x-m": 3, "rubber": {"density": 1100, "//": "dry"}},
    "parts": [{"name": "ball", "shape": "sphere", "material": "rubber", "x-color": 7,
               "parameters": {"//": "all", "x-p": [], "r": {"rest": 0.5, "//": "m"}}}],
    "springs": [{"from": {"part": "ball", "at": {"u": 0, "v": 0, "//": 0}, "x-a": 1},
                 "to": {"world": {"t": [0, 1], "points": [[2, 0, 0], [3, 0, 0]], "//": 0}}, "stiffness": 1}],
    "camera": {"x-lens": null}
  })json";
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::parse_scene("s.json", text, {}, diagnostics);
  CHECK(diagnostics.text().empty());
  CHECK(scene->body.parts()[0]->density() == 1100);
  CHECK(schema().accepts(nlohmann::json::parse(text)));
}

TEST_CASE("points given by direction or by position are resolved on the rest shape") {
  const std::string text = R"json({
    "parts": [{"name": "horn", "shape": "superellipsoid", "deformations": ["taper", "bend"],
               "parameters": {"a3": 2, "eps2": 0.4, "taper.tx": -0.5, "bend.angle": 1, "bend.direction": 0.3}}],
    "tracks": [{"part": "horn", "at": {"direction": [3, 2, 5]}},
               {"part": "horn", "at": {"near": [0.1, 0.2, 0.3]}},
               {"part": "horn", "at": {"near": [0, 1.3, 0]}}]
  })json";
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::parse_scene("s.json", text, {}, diagnostics);
  CHECK(diagnostics.text().empty());
  const auto world_position = [&](std::size_t i) {
    const pliant::Point& point = scene->tracks[i].point;
    const pliant::Part& horn = *point.part;
    return pliant::Vec3<double>(horn.s({point.material}, horn.parameters().rest()).col(0));
  };
  // The plate does not contain the origin. It is thinner than the distance between the samples with which
  // the reader searches along a ray.
  pliant::Diagnostics none;
  const auto plate = pliant::parse_scene("s.json", R"json({
    "parts": [{"name": "plate", "shape": "cylinder", "deformations": ["shear", "bend_offset"],
               "parameters": {"a1": 1e-4, "a2": 1, "bend_offset.b1": 0.5, "bend_offset.b3": 1}}],
    "tracks": [{"part": "plate", "at": {"direction": [0.43, 0, 0.05]}}]
  })json",
                                         {}, none);
  const pliant::Point& on_plate = plate->tracks[0].point;
  const pliant::Vec3<double> found =
      on_plate.part->s({on_plate.material}, on_plate.part->parameters().rest()).col(0);
  CHECK((found.normalized() - pliant::Vec3<double>(0.43, 0, 0.05).normalized()).norm() < 1e-12);
  const pliant::Vec3<double> direction = pliant::Vec3<double>(3, 2, 5).normalized();
  CHECK(scene->tracks[0].point.material.w == 1);
  CHECK((world_position(0).normalized() - direction).norm() < 1e-12);
  CHECK((world_position(1) - pliant::Vec3<double>(0.1, 0.2, 0.3)).norm() < 1e-12);
  CHECK(scene->tracks[2].point.material.w == 1);
  CHECK((world_position(2) - pliant::Vec3<double>(0, 1, 0)).norm() < 0.1);
}

TEST_CASE("settings without effect give a warning") {
  const auto warnings = [](const std::string& members) {
    pliant::Diagnostics diagnostics;
    pliant::parse_scene("s.json", "{\"parts\": [{\"name\": \"a\", \"shape\": \"sphere\",\n" + members + "}]}",
                        {}, diagnostics);
    return diagnostics.text();
  };
  CHECK(
      warnings("\"parameters\": {\"r\": {\"rest\": 1, \"max\": 2}}") ==
      "s.json:2:40: warning: /parts/0/parameters/r/max: 2; this limit has no effect, because r is frozen\n");
  CHECK(warnings("\"fixed\": true, \"velocity\": [1, 0, 0]") ==
        "s.json:2:28: warning: /parts/0/velocity: [1, 0, 0]; it has no effect, because the part is fixed\n");
  CHECK(warnings("\"orientation\": {\"quaternion\": [0.7071, 0.7071, 0, 0]}").empty());
  // The mesh is too coarse for these twists.
  const std::string twist =
      "\"deformations\": [\"twist\"], \"parameters\": {\"twist.angle\": 31.5}, \"resolution\": ";
  CHECK(warnings(twist + "8") ==
        "s.json:2:79: warning: /parts/0/resolution: 8; its mesh has fewer than 8 edges per turn of the "
        "twist; expected a resolution of at least 41\n");
  CHECK(warnings(twist + "41").empty());
  CHECK(warnings("\"deformations\": [\"twist\"], \"parameters\": {\"twist.angle\": 600}")
            .find("no resolution up to 128 is sufficient") != std::string::npos);
}

TEST_CASE("colouring of parts is read") {
  const std::string start =
      R"json({"parts": [{"name": "a", "shape": "sphere", "parameters": {"r": {"stiffness": 1}}},
                        {"name": "b", "shape": "box"}], "coloring": )json";
  const auto coloring = [&](const std::string& text) {
    pliant::Diagnostics diagnostics;
    const auto scene = pliant::parse_scene("s.json", start + text + "}", {}, diagnostics);
    CHECK(diagnostics.text().empty());
    CHECK(schema().accepts(nlohmann::json::parse(start + text + "}")));
    REQUIRE(scene->coloring);
    const auto& parts = scene->body.parts();
    return std::tuple(scene->coloring->by, scene->coloring->range, colors(*scene->coloring, *parts[0]),
                      colors(*scene->coloring, *parts[1]));
  };
  using Range = std::optional<std::array<double, 2>>;
  CHECK(coloring("{\"by\": \"strain\"}") ==
        std::tuple(pliant::SurfaceQuantity::strain, Range(), true, false));
  CHECK(coloring("{\"by\": \"displacement\", \"range\": [-1, 2], \"parts\": [\"b\"]}") ==
        std::tuple(pliant::SurfaceQuantity::displacement, Range({-1, 2}), false, true));
  pliant::Diagnostics diagnostics;
  pliant::parse_scene(
      "s.json", R"json({"parts": [{"name": "a", "shape": "sphere"}], "coloring": {"by": "strain"}})json", {},
      diagnostics);
  CHECK(diagnostics.text().find("/coloring/by: \"strain\"; it has no effect, because no part deforms") !=
        std::string::npos);
}

TEST_CASE("a torque against another part is read, and conserves the momenta of both") {
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::parse_scene("s.json", R"json({
    "gravity": [0, 0, 0],
    "parts": [{"name": "a", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.1, "a3": 0.1}, "velocity": [0, 1, 0]},
              {"name": "b", "shape": "ellipsoid", "parameters": {"a1": 0.2, "a2": 0.1, "a3": 0.1}, "position": [0.5, 0, 0],
               "velocity": [0, 1, 0]}],
    "joints": [{"type": "hinge", "from": {"part": "a", "at": {"u": 0, "v": 0}}, "to": {"part": "b", "at": {"u": 0, "v": 3.141592653589793}},
                "axis": [0, 0, 1]}],
    "torques": [{"part": "a", "against": "b", "torque": [0, 0.5, "cos(3 * t)"], "frame": "body"}, {"part": "b", "torque": [0, 0, 0]}]
  })json",
                                         {}, diagnostics);
  CHECK(diagnostics.text().empty());
  REQUIRE(scene->body.torques().size() == 2);
  CHECK(scene->body.torques()[0]->against == scene->body.parts()[1].get());
  CHECK(scene->body.torques()[1]->against == nullptr);
  Simulation simulation(scene->body, "rk4");
  const pliant::Ledger start = simulation.ledger();
  for (int i = 0; i < 500; ++i) simulation.step(1e-3);
  const pliant::Ledger end = simulation.ledger();
  CHECK((end.momentum - start.momentum).norm() <= 1e-12 * start.momentum.norm());
  CHECK((end.angular_momentum - start.angular_momentum).norm() <= 1e-12 * start.angular_momentum.norm());
  CHECK(std::abs(end.balance) <= 1e-11 * start.kinetic);
  CHECK(end.work[static_cast<int>(pliant::Work::forces)] > 1e-2);
}

TEST_CASE("the appearance of a plane is read") {
  pliant::Diagnostics diagnostics;
  const auto scene = pliant::parse_scene("s.json", R"json({
    "parts": [{"name": "a", "shape": "sphere"}],
    "contact": {"planes": [{"name": "floor", "point": [0, 0, -2]},
                           {"name": "wall", "point": [-2, 0, 0], "normal": [1, 0, 0], "shown": {"width": 2, "height": 3, "color": "#ff0000"}}]}
  })json",
                                         {}, diagnostics);
  CHECK(diagnostics.text().empty());
  REQUIRE(scene->planes.size() == 1);
  CHECK(scene->planes[0].plane == 1);
  CHECK(scene->planes[0].width == 2);
  CHECK(scene->planes[0].height == 3);
  CHECK(scene->planes[0].color == pliant::Color{1, 0, 0});
}

TEST_CASE("the sleep settings are read") {
  pliant::Diagnostics diagnostics;
  const std::string start = R"json({"parts": [{"name": "a", "shape": "sphere"}], "contact": {)json";
  auto sleep_of = [&](const char* contact) {
    return pliant::parse_scene("s.json", start + contact + "}}", {}, diagnostics)->body.contact.sleep;
  };
  CHECK_FALSE(sleep_of("").has_value());
  const std::optional<pliant::Sleep> given = sleep_of(R"json("sleep": {"speed": 0.01, "after": 2})json"),
                                     short_one = sleep_of(R"json("sleep": {"speed": 0.01})json");
  REQUIRE((given && short_one));
  CHECK(given->speed == 0.01);
  CHECK(given->after == 2);
  CHECK(short_one->after == 0.5);
}

TEST_CASE("Newton's cradle: the last ball swings as high as the first, and the others hang still") {
  // The amplitude is 50 degrees, and the length 0.6 m: after half a period the last ball is at its summit.
  const double length = 0.6, amplitude = 50 * kPi / 180,
               half_period = 2 * pliant::test::elliptic_K(amplitude) * std::sqrt(length / 9.81),
               height = 1 - length * std::cos(amplitude);
  double highest = 0, first_later = 0;
  run("cradle.json", 2 * half_period, 1e-8, [&](const Simulation& simulation, const pliant::Ledger&) {
    const pliant::State& state = simulation.state();
    highest = std::max(highest, state.q[4 * 7 + 2]);
    first_later = state.q[2];
    for (int ball = 1; ball <= 3; ++ball) REQUIRE(state.q[7 * ball + 2] == Approx(0.4).margin(1e-9));
    if (simulation.time() > 0.5 * half_period + 2e-3 && simulation.time() < 1.5 * half_period - 2e-3)
      REQUIRE(state.q[2] == Approx(0.4).margin(1e-9));  // the first ball
  });
  CHECK(highest == Approx(height).margin(1e-5));
  CHECK(first_later == Approx(height).margin(1e-4));
}

TEST_CASE("the JSON Schema refuses the bad scenes that a schema can refuse") {
  // The schema accepts these bad scenes. Their errors concern formulas, the JSON text itself, or names and
  // numbers that depend on other names and numbers; types, keys and ranges cannot describe these errors.
  const std::vector<std::string> passed{"anchor_not_finite",
                                        "camera_at_its_target",
                                        "coloring_of_unknown_part",
                                        "coloring_range_falls",
                                        "contact_beyond",
                                        "density_too_large",
                                        "drive_softer_than_zero",
                                        "duplicate_key",
                                        "duplicate_part_name",
                                        "dynamic_exponent_out_of_range",
                                        "elasticity_faults",
                                        "exponent_out_of_range",
                                        "fixed_but_dynamic",
                                        "folded_bend",
                                        "force_on_unknown_part",
                                        "formula_divides_by_zero",
                                        "formula_double_star",
                                        "formula_infinite",
                                        "formula_missing_product",
                                        "formula_not_closed",
                                        "formula_of_a_negative_number",
                                        "formula_unknown_name",
                                        "formula_wrong_arguments",
                                        "frame_rate_absurd",
                                        "frozen_but_moving",
                                        "frozen_but_stiff",
                                        "hinge_without_direction",
                                        "inertia_impossible",
                                        "inertia_not_symmetric",
                                        "inertia_of_a_deforming_part",
                                        "initial_outside_limits",
                                        "joint_end_jumps",
                                        "joint_in_the_world",
                                        "joint_length_zero",
                                        "joint_names_twice",
                                        "joint_to_itself",
                                        "joint_to_unknown_part",
                                        "joint_within_a_rigid_part",
                                        "key_frames_at_the_same_time",
                                        "key_frames_of_different_number",
                                        "key_frames_out_of_order",
                                        "key_frames_too_far_apart",
                                        "light_without_direction",
                                        "limits_beyond_the_range",
                                        "limits_crossed",
                                        "local_and_fixed",
                                        "local_basis",
                                        "local_basis_too_large",
                                        "local_law_of_the_other_kind",
                                        "local_laws_that_clash",
                                        "material_called_by_an_extension",
                                        "motion_beyond",
                                        "negative_size",
                                        "nested_too_deep",
                                        "no_materials",
                                        "nul_in_text",
                                        "obstacles_beyond",
                                        "parameter_as_text",
                                        "parameter_of_no_deformation",
                                        "parameter_out_of_a_second_link",
                                        "parameter_without_its_deformation",
                                        "point_far_outside",
                                        "point_in_a_direction_of_a_torus",
                                        "point_in_an_empty_direction",
                                        "point_in_no_direction",
                                        "point_near_a_closed_end",
                                        "point_outside_the_latitudes",
                                        "quaternion_not_unit",
                                        "rest_outside_limits",
                                        "ring_around_a_moving_point",
                                        "ring_outside_of_a_part",
                                        "ring_with_a_drive",
                                        "spring_names_twice",
                                        "spring_to_itself",
                                        "spring_to_unknown_part",
                                        "spring_without_a_part",
                                        "spring_without_direction",
                                        "stabilization_free_without_gains",
                                        "stiffness_factor_negative",
                                        "stiffness_factor_of_an_unknown_law",
                                        "stiffness_given_twice",
                                        "stiffness_not_definite",
                                        "stiffness_not_square",
                                        "stiffness_not_symmetric",
                                        "stiffness_of_unknown_parameters",
                                        "stiffness_row_too_short",
                                        "taper_out_of_range",
                                        "tiny_density",
                                        "tolerance_of_rk4",
                                        "too_many_dynamic_parameters",
                                        "too_many_steps",
                                        "torque_against",
                                        "torus_closed",
                                        "track_of_unknown_part",
                                        "unknown_material",
                                        "unknown_parameter",
                                        "unknown_parameter_with_no_near_name",
                                        "zero_axis",
                                        "zero_quaternion",
                                        "zero_size"};
  std::vector<std::string> accepted;
  for (const fs::path& path : scenes_in(PLIANT_BAD_SCENES)) {
    const nlohmann::json scene = json_of(path);
    if (!scene.is_discarded() && schema().accepts(scene)) accepted.push_back(path.stem().string());
  }
  CHECK(accepted == passed);
}

}  // namespace scenes_test
