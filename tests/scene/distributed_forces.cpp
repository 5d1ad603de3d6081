// Distributed forces in scene files, Eq. (11): forces per area on surfaces and per mass in bodies, by
// formulas of place, velocity and normal.
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"
#include "motion.h"
#include "scene_run.h"

namespace distributed_forces_test {

using namespace pliant;
using test::messages_of;
using Run = test::SceneRun;

namespace {

/// Returns the centre of mass of the only part of a scene, which is rigid, m, world.
Vec3<double> centre(const Run& run) {
  const Inertia<double>& inertia = run.scene->body.parts()[0]->rest_inertia();
  const State& state = run.simulation->state();
  return run.simulation->model().position(state, 0) +
         run.simulation->model().orientation(state, 0) * Vec3<double>(inertia.moment / inertia.mass);
}

/// Returns a scene without gravity with one part and one distributed force. part: more keys of the part;
/// list: surface_forces or body_forces; force: keys of the force.
std::string scene_of(const std::string& part, const std::string& list, const std::string& force) {
  return R"json({"gravity": [0, 0, 0], "parts": [{"name": "a", )json" + part + "}], \"" + list +
         R"json(": [{"part": "a", )json" + force + "}]}";
}
constexpr const char* kTwisted =
    R"json("shape": "superellipsoid", "deformations": ["taper", "twist", "bend"],
           "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.5, "eps1": 0.6, "eps2": 1.3, "taper.tx": 0.3,
                          "twist.angle": 0.8, "bend.angle": 0.7}, "position": [0.2, -0.1, 0.4],
           "orientation": {"axis": [1, 2, 0.5], "angle": 0.9})json";
constexpr const char* kEllipsoid =
    R"json("shape": "ellipsoid", "density": 500, "parameters": {"a1": {"rest": 0.3, "dynamic": true},
           "a2": {"rest": 0.2, "dynamic": true}, "a3": {"rest": 0.5, "dynamic": true}}, "position": [0, 0, -2])json";

}  // namespace

TEST_CASE("the same pressure everywhere moves no body of constant shape", "[loads]") {
  const Run run(scene_of(kTwisted, "surface_forces", R"json("pressure": 1e5)json"));
  const double force = 1e5 * 0.3, mass = run.scene->body.parts()[0]->total_mass();
  CHECK(run.v_dot().norm() <= 1e-12 * force / mass);
}

TEST_CASE("buoyancy is the weight of the displaced water, and a pressure does the work p dV", "[loads]") {
  double errors[2];
  for (const int k : {0, 1}) {
    const Run run(scene_of(kEllipsoid, "surface_forces",
                           R"json("pressure": "-9810 * z", "resolution": )json" + std::to_string(8 << k)));
    const VecX<double> a = run.v_dot();
    errors[k] = std::abs(a[2] - 9.81 * 1000 / 500);
    CHECK(a.head<2>().norm() <= 1e-12 * a[2]);
    CHECK(a.segment<3>(3).norm() <= 1e-10);
    // M = m / 5 for each semi-axis of an ellipsoid. dV/da_k = V / a_k. The variation of the pressure over
    // the body exerts no generalised force on a semi-axis.
    const double V = 4 * kPi / 3 * 0.3 * 0.2 * 0.5, m = 500 * V, p = 9810 * 2;
    const double lengths[] = {0.3, 0.2, 0.5};
    for (int i = 0; i < 3; ++i)
      CHECK(a[6 + i] == Approx(-p * V / lengths[i] / (m / 5)).epsilon(0.02 / (1 << 2 * k)));
  }
  CHECK(errors[0] <= 0.01 * 19.62);
  CHECK(errors[1] == Approx(errors[0] / 4).epsilon(0.1));  // second order
}

TEST_CASE("a drag of the surface of a box is exact, because its faces are flat", "[loads]") {
  const Run run(scene_of(
      R"json("shape": "box", "density": 100, "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.5},
                               "velocity": [1, 2, 3], "angular_velocity": [0, 0, 2])json",
      "surface_forces",
      R"json("traction": ["-4 * vx", "-4 * vy", "-4 * vz"], "pressure": "3 * (vn - vx * nx - vy * ny - vz * nz)")json"));
  const double area = 8 * (0.3 * 0.2 + 0.2 * 0.5 + 0.3 * 0.5), mass = 100 * 8 * 0.3 * 0.2 * 0.5;
  const VecX<double> a = run.v_dot();
  for (int i = 0; i < 3; ++i) CHECK(a[i] == Approx(-4 * area * (i + 1) / mass).epsilon(1e-12));
}

TEST_CASE("a force along the normal acts on the side from which the wind blows", "[loads]") {
  // Newton's pressure on a plate that faces a wind of 3 m/s along x acts on the front face only.
  const Run run(
      scene_of(R"json("shape": "box", "density": 100, "parameters": {"a1": 0.01, "a2": 0.2, "a3": 0.5},
                               "velocity": [1, 0, 0])json",
               "surface_forces", R"json("pressure": "2 * max(-(3 - vx) * nx, 0) ^ 2")json"));
  const double mass = 100 * 8 * 0.01 * 0.2 * 0.5;
  CHECK(run.v_dot()[0] == Approx(2 * 4.0 * 4 * 0.2 * 0.5 / mass).epsilon(1e-12));
}

TEST_CASE("formulas read the place of a point at rest", "[loads]") {
  // A traction along y on the upper half of a box.
  const Run run(
      scene_of(R"json("shape": "box", "density": 100, "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.5},
                               "position": [5, 6, 7])json",
               "surface_forces", R"json("traction": [0, "7 * step(Z)", 0])json"));
  const double area = 8 * (0.3 * 0.2 + 0.2 * 0.5 + 0.3 * 0.5), mass = 100 * 8 * 0.3 * 0.2 * 0.5;
  CHECK(run.v_dot()[1] == Approx(7 * area / 2 / mass).epsilon(1e-12));
}

TEST_CASE("pressure on a soft shell gives the forces of the law of pressure", "[loads]") {
  const std::string shell = R"json("shape": "ellipsoid", "shell": true, "density": 0.5,
      "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.25}, "local": {"resolution": 3, "laws": [)json";
  const std::string membrane =
      R"json({"type": "neo_hookean_membrane", "E": 1e5, "nu": 0.5, "thickness": 1e-3})json";
  const Run by_force(scene_of(shell + membrane + "]}", "surface_forces", R"json("pressure": -80)json"));
  const Run by_law(scene_of(shell + membrane + R"json(, {"type": "pressure", "p": 80}]})json",
                            "surface_forces", R"json("pressure": 0)json"));
  const VecX<double> a = by_force.v_dot(), b = by_law.v_dot();
  CHECK(b.norm() > 1);
  CHECK((a - b).norm() <= 1e-10 * b.norm());
}

TEST_CASE("an affine field of force per mass is exact", "[loads]") {
  // Every point is an isotropic oscillator about the origin, so a rigid body moves without a torque.
  const std::string force = R"json("acceleration": ["-9 * x", "-9 * y", "-9 * z"])json";
  Run run(scene_of(kTwisted, "body_forces", force), "dop853", 1e-11);
  const Vec3<double> start = centre(run);
  run.simulation->step(0.7);
  CHECK((centre(run) - start * std::cos(3 * 0.7)).norm() <= 1e-9);
  CHECK(run.simulation->state().v.segment<3>(3).norm() <= 1e-9);
}

TEST_CASE("a force per mass acts on the nodes of soft parts", "[loads]") {
  for (const char* shell : {"true", "false"}) {
    const std::string law =
        std::string(shell) == "true"
            ? R"json({"type": "neo_hookean_membrane", "E": 1e5, "nu": 0.4, "thickness": 1e-3})json"
            : R"json({"type": "neo_hookean", "E": 1e5, "nu": 0.4})json";
    const Run run(scene_of(std::string(R"json("shape": "sphere", "shell": )json") + shell +
                               R"json(, "local": {"resolution": 2, "laws": [)json" + law + "]}",
                           "body_forces", R"json("acceleration": [0, 3, "2 * t"])json"));
    const VecX<double> a = run.v_dot();
    CHECK(a[1] == Approx(3).epsilon(1e-12));
    CHECK(a[0] == Approx(0).margin(1e-10));
    CHECK(a.tail(a.size() - 2).norm() <= 1e-9);
  }
}

TEST_CASE("distributed forces keep the order of each method, and the energy balance contains their work",
          "[loads]") {
  // A soft ellipsoid swings in water and is damped.
  const std::string text = scene_of(
      R"json("shape": "ellipsoid", "density": 600, "deformations": ["bend"],
             "parameters": {"a1": {"rest": 0.3, "stiffness": 4e4}, "a2": 0.2, "a3": {"rest": 0.5, "stiffness": 5e4},
                            "bend.angle": {"rest": 0.2, "stiffness": 600}},
             "orientation": {"axis": [1, 1, 0], "angle": 0.5}, "velocity": [0.3, 0.1, -0.5])json",
      "surface_forces",
      R"json("pressure": "2000 * smoothstep(-2, 2, -z)", "traction": ["-30 * vx", "-30 * vy + 5 * nz", "-40 * vz"], "resolution": 2)json");
  Run reference(text, "dop853", 1e-12);
  reference.simulation->step(0.2);
  CHECK(std::abs(reference.simulation->ledger().balance) <= 1e-9);
  for (const auto& [method, order] : {std::pair("semi_implicit_euler", 1), std::pair("linearly_implicit", 2),
                                      std::pair("implicit_midpoint", 2), std::pair("rk4", 4)}) {
    double errors[2];
    for (const int k : {0, 1}) {
      Run run(text, method);
      const int n = 20 << k;
      for (int i = 0; i < n; ++i) run.simulation->step(0.2 / n);
      errors[k] = (run.simulation->state().v - reference.simulation->state().v).norm();
    }
    CAPTURE(method, errors[0], errors[1]);
    CHECK(std::log2(errors[0] / errors[1]) > order - 0.35);
  }
}

TEST_CASE("faulty distributed forces are reported at their place", "[loads]") {
  const std::string part = R"json("shape": "sphere")json";
  CHECK(messages_of(scene_of(part, "surface_forces", R"json("resolution": 4)json"))
            .find("expected a \"traction\" or a \"pressure\"") != std::string::npos);
  CHECK(messages_of(scene_of(part, "surface_forces", R"json("pressure": "3 * height")json")).find("height") !=
        std::string::npos);
  CHECK(messages_of(scene_of(part, "body_forces", R"json("acceleration": ["nx", 0, 0])json")).find("nx") !=
        std::string::npos);
  CHECK(messages_of(R"json({"parts": [{"name": "a", "shape": "sphere"}], "forces": [{"part": "a",
      "at": {"u": 0, "v": 0}, "force": ["vx", 0, 0]}]})json")
            .find("vx") != std::string::npos);
  CHECK(
      messages_of(
          scene_of(
              R"json("shape": "sphere", "inertia": {"mass": 1, "moments": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]})json",
              "body_forces", R"json("acceleration": [1, 0, 0])json"))
          .find("inertia") != std::string::npos);
}

TEST_CASE("a body force that is not affine converges with its resolution", "[loads]") {
  // The means of Z^4 over a sphere and of Z^6 over a box of half height 1. The rule of Gauss in u, v and w
  // converges exponentially.
  for (const auto& [shape, power, exact] :
       {std::tuple("sphere", "4", 3.0 / 35), std::tuple("box", "6", 1.0 / 7)}) {
    std::vector<double> errors;
    for (const int resolution : {4, 8, 16}) {
      const Run run(scene_of(std::string("\"shape\": \"") + shape + "\"", "body_forces",
                             std::string("\"acceleration\": [0, 0, \"Z^") + power +
                                 "\"], \"resolution\": " + std::to_string(resolution)));
      errors.push_back(std::abs(run.v_dot()[2] - exact));
    }
    CAPTURE(shape, errors);
    CHECK(errors[0] <= 0.02);
    CHECK(errors[1] <= 1e-5);
    CHECK(errors[2] <= 1e-12);
  }
}

TEST_CASE("body forces act on parts with every basis of local deformation", "[loads]") {
  for (const char* local :
       {R"json("basis": "polynomial", "degree": 2, "laws": [{"type": "elastic", "E": 1e6}])json",
        R"json("basis": "modes", "modes": 6, "resolution": 2, "laws": [{"type": "elastic", "E": 1e6}])json",
        R"json("resolution": 2, "laws": [{"type": "elastic", "E": 1e6}])json"}) {
    CAPTURE(local);
    const Run run(scene_of(std::string("\"shape\": \"sphere\", \"local\": {") + local + "}", "body_forces",
                           R"json("acceleration": [0, 3, 0])json"));
    const VecX<double> a = run.v_dot();
    CHECK(a[1] == Approx(3).epsilon(1e-10));
    CHECK(a.tail(a.size() - 6).norm() <= 1e-7);
  }
}

TEST_CASE("the energy balance contains the work of distributed forces on bodies in contact",
          "[loads][contact]") {
  const std::string text =
      scene_of(R"json("shape": "box", "parameters": {"a1": 0.2, "a2": 0.2, "a3": 0.1},
      "position": [0, 0, 0.1], "velocity": [1, 0, 0])json",
               "body_forces", R"json("acceleration": ["2 - 0.5 * vx", 0, "-10 - x"])json");
  const std::string with_floor = text.substr(0, text.size() - 1) +
                                 R"json(, "contact": {"friction": 0.3, "planes": [{"name": "floor"}]}})json";
  double errors[2];
  for (const int k : {0, 1}) {
    Run run(with_floor, "semi_implicit_euler");
    for (int i = 0; i < 100 << k; ++i) run.simulation->step(0.005 / (1 << k));
    errors[k] = std::abs(run.simulation->ledger().balance);
  }
  const double mass = 1000 * 8 * 0.2 * 0.2 * 0.1;
  CAPTURE(errors[0], errors[1]);
  CHECK(errors[0] <= 0.02 * mass);
  CHECK(errors[1] <= 0.6 * errors[0] + 1e-12);
}

TEST_CASE("a part falls asleep if its distributed forces read nothing but its own points",
          "[loads][contact]") {
  for (const auto& [pressure, sleeps] :
       {std::pair("0.001 * vn", true), std::pair("0.001 * vn + 0.001 * sin(t)", false)}) {
    const std::string text = scene_of(R"json("shape": "box", "position": [0, 0, 1])json", "surface_forces",
                                      std::string("\"pressure\": \"") + pressure + "\", \"resolution\": 1");
    Run run("{\"contact\": {\"planes\": [{\"name\": \"floor\"}], \"sleep\": {\"speed\": 0.01}}, " +
            text.substr(text.find("\"parts\"")));
    for (int i = 0; i < 200; ++i) run.simulation->step(0.01);
    CAPTURE(pressure);
    CHECK(pliant::sleeps(run.simulation->state(), 0) == sleeps);
  }
}

TEST_CASE("a pressure that is not finite is named, with fixed steps and with a tolerance", "[loads]") {
  const std::string text = scene_of(R"json("shape": "sphere")json", "surface_forces",
                                    R"json("name": "wind", "pressure": "z / (vx - vx)")json");
  for (const double tolerance : {0.0, 1e-6}) {
    Run run(text, "dop853", tolerance);
    CHECK_THROWS_WITH(run.simulation->step(0.1), test::has_text("distributed force 'wind'"));
  }
}

TEST_CASE("distributed forces without effect and hidden names are reported", "[loads]") {
  const std::string pressure = R"json("pressure": "x")json";
  CHECK_THAT(messages_of(scene_of(R"json("shape": "sphere", "fixed": true)json", "surface_forces", pressure)),
             test::has_text("has no effect"));
  const std::string text = scene_of(R"json("shape": "sphere")json", "surface_forces", pressure);
  CHECK_THAT(
      messages_of(text.substr(0, text.size() - 1) + R"json(, "sensors": [{"name": "x", "value": "t"}]})json"),
      test::has_text("another name of the sensor"));
  // A part with a fault causes no second message.
  const std::string faulty = messages_of(scene_of(
      R"json("shape": "sphere", "local": {"laws": [{"type": "membrane", "E": 1e5, "thickness": 0.01}]})json",
      "body_forces", R"json("acceleration": [1, 0, 0])json"));
  CHECK(faulty.find("inertia") == std::string::npos);
}

TEST_CASE("a scene gives a mass distribution by a formula", "[mass][long]") {
  auto scene_with = [](const std::string& formula, std::string& messages) {
    Diagnostics diagnostics;
    std::unique_ptr<Scene> scene;
    try {
      scene = parse_scene("s.json",
                          R"json({"parts": [{"name": "a", "shape": "box", "density": 500,
                             "mass_distribution": ")json" +
                              formula + "\"}]}",
                          {}, diagnostics);
    } catch (const SceneError&) {
    }
    messages = diagnostics.text();
    return scene;
  };
  std::string messages;
  const auto scene = scene_with("1 + 0.5 * X + 0 * u * v * w * Y * Z", messages);
  CHECK(messages.empty());
  const Inertia<double>& inertia = scene->body.parts()[0]->rest_inertia();
  CHECK(inertia.mass == Approx(500 * 8).epsilon(1e-13));
  CHECK(inertia.moment[0] == Approx(500 * 8 * 0.5 / 3).epsilon(1e-13));
  scene_with("1 + t", messages);
  CHECK(messages.find("without t") != std::string::npos);
  scene_with("1 + height", messages);
  CHECK(messages.find("height") != std::string::npos);
  scene_with("1 + 10000 * exp(-2000 * ((X - 0.3)^2 + (Y - 0.2)^2 + (Z - 0.1)^2))", messages);
  CHECK_THAT(messages, test::has_text("relative error of about"));
  scene_with("1 + step(X * Y * Z - 0.1)", messages);
  CHECK_THAT(messages, test::has_text("relative error of about"));
  scene_with("X", messages);
  CHECK(messages.find("mass distribution is -") != std::string::npos);
}

}  // namespace distributed_forces_test
