// Actuation in scene files: drives and limits of joints, drives of parameters, muscles, forces and sensors
// that read the state; and messages about faulty names.
#include <cmath>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"
#include "motion.h"
#include "scene_run.h"

namespace actuation_scenes_test {

using namespace pliant;
using test::messages_of;
using Run = test::SceneRun;

namespace {

/// Returns a scene without gravity, in which a hinge along y connects an end of a bar to the world. The
/// centre of the bar is 0.5 m from the hinge. keys: more keys of the hinge; more: more keys of the scene.
std::string hinged_bar(const std::string& keys, const std::string& more = "") {
  return R"json({"gravity": [0, 0, 0],
    "parts": [{"name": "bar", "shape": "box", "parameters": {"a1": 0.5, "a2": 0.05, "a3": 0.05},
               "inertia": {"mass": 2, "moments": [[0.01, 0, 0], [0, 0.3, 0], [0, 0, 0.3]]},
               "position": [0.5, 0, 0]}],
    "joints": [{"type": "hinge", "name": "pin", "from": {"part": "bar", "at": {"direction": [-1, 0, 0]}},
                "to": {"world": [0, 0, 0]}, "axis": [0, 1, 0])json" +
         (keys.empty() ? "" : ", " + keys) +
         "}],\n\"sensors\": [{\"name\": \"angle\", \"value\": \"pin.angle\"}," +
         R"json({"name": "rate", "value": "pin.rate"}])json" + (more.empty() ? "" : ", " + more) + "}";
}
constexpr double kInertia = 0.3 + 2 * 0.5 * 0.5;  // moment of inertia of the bar about the hinge, kg m^2

/// Returns x and x_dot of x_ddot = -(k (x - 1) + c x_dot) / m from rest at x = 0, with c^2 < 4 k m.
std::array<double, 2> step_response(double k, double c, double m, double t) {
  const double decay = c / (2 * m), omega = std::sqrt(k / m - decay * decay), e = std::exp(-decay * t);
  return {1 - e * (std::cos(omega * t) + decay / omega * std::sin(omega * t)),
          e * (omega + decay * decay / omega) * std::sin(omega * t)};
}

}  // namespace

TEST_CASE("a servo turns a hinge to its target with the response of a damped oscillator", "[actuation]") {
  Run run(hinged_bar(R"json("drive": {"target": "1", "stiffness": 20, "damping": 3})json"), "dop853", 1e-11);
  for (int i = 0; i < 10; ++i) {
    run.simulation->step(0.1);
    const auto expected = step_response(20, 3, kInertia, run.simulation->time());
    CHECK(run.sensor(0) == Approx(expected[0]).margin(1e-9));
    CHECK(run.sensor(1) == Approx(expected[1]).margin(1e-8));
  }
}

TEST_CASE("a servo of a ball joint turns it to a rotation vector, with an equal response about each axis",
          "[actuation]") {
  Run run(R"json({"gravity": [0, 0, 0],
    "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.5},
               "inertia": {"mass": 2, "moments": [[0.3, 0, 0], [0, 0.3, 0], [0, 0, 0.3]]}}],
    "joints": [{"type": "ball", "name": "neck", "from": {"part": "ball", "at": {"u": 0, "v": 0, "w": 0}},
                "to": {"world": [0, 0, 0]}, "axis": [0, 0, 1],
                "drive": {"target": [0, 0.6, 0.8], "stiffness": 20, "damping": 1}}],
    "sensors": [{"name": "size", "value": "sqrt(neck.twist^2 + neck.swing_y^2 + neck.swing_z^2)"},
                {"name": "share", "value": "neck.swing_y / neck.swing_z"}]})json",
          "dop853", 1e-11);
  for (int i = 0; i < 5; ++i) {
    run.simulation->step(0.1);
    CHECK(run.sensor(0) == Approx(step_response(20, 1, 0.3, run.simulation->time())[0]).margin(1e-9));
    CHECK(run.sensor(1) == Approx(0.75).margin(1e-8));
  }
}

TEST_CASE(
    "a servo moves a slider to its target with the response of a damped oscillator, and a motor to its rate",
    "[actuation]") {
  const auto cart = [](const std::string& drive) {
    return R"json({"gravity": [0, 0, 0], "parts": [{"name": "cart", "shape": "box", "mass": 2}],
      "joints": [{"type": "slider", "name": "rail", "from": {"part": "cart", "at": {"u": 0, "v": 0, "w": 0}},
                  "to": {"world": [0, 0, 0]}, "axis": [1, 0, 0], "drive": )json" +
           drive + R"json(}],
      "sensors": [{"name": "x", "value": "rail.position"}, {"name": "rate", "value": "rail.rate"}]})json";
  };
  Run servo(cart(R"json({"target": "1", "stiffness": 20, "damping": 3})json"), "dop853", 1e-11);
  for (int i = 0; i < 10; ++i) {
    servo.simulation->step(0.1);
    const auto expected = step_response(20, 3, 2, servo.simulation->time());
    CHECK(servo.sensor(0) == Approx(expected[0]).margin(1e-9));
    CHECK(servo.sensor(1) == Approx(expected[1]).margin(1e-8));
  }
  Run motor(cart(R"json({"rate": 2, "damping": 1e4, "max_force": 4})json"), "dormand_prince", 1e-9);
  motor.simulation->step(0.5);
  CHECK(motor.sensor(1) == Approx(0.5 * 4 / 2).epsilon(1e-7));
  motor.simulation->step(1);
  CHECK(motor.sensor(1) == Approx(2).epsilon(1e-3));
}

TEST_CASE("a motor accelerates by its largest torque until it reaches its rate", "[actuation]") {
  Run run(hinged_bar(R"json("drive": {"rate": 2, "damping": 1e4, "max_force": 4})json"), "dormand_prince",
          1e-9);
  const double acceleration = 4 / kInertia;
  run.simulation->step(0.2);
  CHECK(run.sensor(1) == Approx(acceleration * 0.2).epsilon(1e-7));
  CHECK(run.sensor(0) == Approx(acceleration * 0.02).epsilon(1e-7));
  run.simulation->step(0.3);
  CHECK(run.sensor(1) == Approx(2).epsilon(1e-3));
}

TEST_CASE("a drive with constants is a spring, whose energy is in the ledger", "[actuation]") {
  Run spring(hinged_bar(R"json("drive": {"target": 0.5, "stiffness": 20, "damping": 3})json"), "rk4");
  Run servo(hinged_bar(R"json("drive": {"target": "0.5 + 0 * t", "stiffness": 20, "damping": 3})json"),
            "rk4");
  CHECK(spring.simulation->ledger().springs == Approx(0.5 * 20 * 0.25));
  for (Run* run : {&spring, &servo}) {
    test::run(*run->simulation, 1, 2000);
    CHECK(std::abs(run->simulation->ledger().balance) < 1e-10);
  }
  CHECK(spring.simulation->state().q == servo.simulation->state().q);
  CHECK(spring.simulation->ledger().work[static_cast<int>(Work::actuation)] == 0);
  CHECK(servo.simulation->ledger().springs == 0);
  const Ledger moved = servo.simulation->ledger();
  CHECK(moved.work[static_cast<int>(Work::actuation)] == Approx(moved.kinetic).epsilon(1e-8));
}

TEST_CASE("a limit of a hinge reverses the rate and multiplies it by the restitution", "[actuation]") {
  const std::string limits = R"json("limits": [-1, 0.7], "restitution": 0.6,
                                    "drive": {"force": 4, "max_force": 4})json";
  // A constant torque moves the bar from rest; at the impact at 0.7 rad, the rate is reversed and multiplied
  // by 0.6.
  const double a = 4 / kInertia, at_impact = std::sqrt(2 * a * 0.7), t_impact = at_impact / a, after = 0.1;
  for (const std::string method : {"rk4", "semi_implicit_euler", "dormand_prince"}) {
    std::vector<double> errors;
    for (const int steps : {400, 800, 1600}) {
      Run run(hinged_bar(limits), method);
      test::run(*run.simulation, t_impact + after, steps);
      errors.push_back(std::abs(run.sensor(1) - (-0.6 * at_impact + a * after)));
      CHECK(std::abs(run.simulation->ledger().balance) < 0.02 * at_impact * at_impact * kInertia);
    }
    CAPTURE(method, errors);
    CHECK(errors[2] < 0.02 * at_impact);
  }
}

TEST_CASE("a limit stops a joint against a force, and a range may contain half a turn", "[actuation]") {
  for (const std::string method : {"rk4", "semi_implicit_euler", "esdirk", "implicit_midpoint"}) {
    CAPTURE(method);
    Run run(hinged_bar(R"json("limits": [-0.5, 3.8], "drive": {"force": 1})json"), method);
    test::run(*run.simulation, 4, 2000);
    CHECK(run.sensor(0) == Approx(3.8 - 2 * kPi).margin(1e-6));
    CHECK(std::abs(run.sensor(1)) < 1e-9);
  }
}

TEST_CASE("limits bound the swing and the twist of a ball joint and the position of a slider",
          "[actuation]") {
  const std::string text = R"json({"gravity": [0, 0, 0],
    "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.5}, "angular_velocity": [1, 2, -1]},
              {"name": "cart", "shape": "box", "position": [3, 0, 0], "velocity": [1, 0, 0]}],
    "joints": [{"type": "ball", "name": "neck", "from": {"part": "ball", "at": {"u": 0, "v": 0, "w": 0}},
                "to": {"world": [0, 0, 0]}, "max_swing": 0.4, "twist_limits": [-0.2, 0.3], "restitution": 1},
               {"type": "slider", "name": "rail", "from": {"part": "cart", "at": {"u": 0, "v": 0, "w": 0}},
                "to": {"world": [3, 0, 0]}, "axis": [1, 0, 0], "limits": [-0.2, 0.3], "restitution": 1}],
    "sensors": [{"name": "swing", "value": "sqrt(neck.swing_y^2 + neck.swing_z^2)"},
                {"name": "twist", "value": "neck.twist"}, {"name": "x", "value": "rail.position"}]})json";
  Run run(text, "rk4");
  const double energy = run.simulation->ledger().energy();
  double swing = 0, lowest = 0, highest = 0, left = 0, right = 0;
  for (int i = 0; i < 3000; ++i) {
    run.simulation->step(1e-3);
    swing = std::max(swing, run.sensor(0));
    lowest = std::min(lowest, run.sensor(1));
    highest = std::max(highest, run.sensor(1));
    left = std::min(left, run.sensor(2));
    right = std::max(right, run.sensor(2));
  }
  CHECK(swing == Approx(0.4).margin(3e-3));
  CHECK(lowest == Approx(-0.2).margin(3e-3));
  CHECK(highest == Approx(0.3).margin(3e-3));
  CHECK(left == Approx(-0.2).margin(2e-3));
  CHECK(right == Approx(0.3).margin(2e-3));
  CHECK(run.simulation->ledger().energy() == Approx(energy).epsilon(1e-2));
}

TEST_CASE("a twist passes half a turn within its limits, and is the rotation that remains after the swing",
          "[actuation]") {
  const std::string text = R"json({"gravity": [0, 0, 0],
    "parts": [{"name": "ball", "shape": "sphere", "parameters": {"r": 0.5}, "angular_velocity": [1, 0, 0]}],
    "joints": [{"type": "ball", "name": "neck", "from": {"part": "ball", "at": {"u": 0, "v": 0, "w": 0}},
                "to": {"world": [0, 0, 0]}, ROTATION "twist_limits": [-0.5, 3.8]}],
    "sensors": [{"name": "twist", "value": "neck.twist"}, {"name": "y", "value": "neck.swing_y"},
                {"name": "z", "value": "neck.swing_z"}]})json";
  auto with = [&](const std::string& rotation) {
    std::string scene = text;
    return scene.replace(scene.find("ROTATION"), 8, rotation);
  };
  Run run(with(""));
  for (int i = 0; i < 700; ++i) {
    run.simulation->step(5e-3);
    const double expected =
        run.simulation->time() > kPi ? run.simulation->time() - 2 * kPi : run.simulation->time();
    REQUIRE(run.sensor(0) == Approx(expected).margin(1e-6));
  }
  test::run(*run.simulation, 1, 200);
  CHECK(run.sensor(0) == Approx(3.8 - 2 * kPi).margin(1e-6));
  // The key "rotation" of the joint is the inverse of `turn`. At time 0 the ball is therefore turned by
  // `turn`: by 60 degrees about x, then by 90 degrees about y.
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(kPi / 2, Eigen::Vector3d::UnitY()) *
                                Eigen::AngleAxisd(kPi / 3, Eigen::Vector3d::UnitX()));
  const Eigen::AngleAxisd back(turn.conjugate());
  std::ostringstream rotation;
  rotation.precision(17);
  rotation << R"("rotation": {"axis": [)" << back.axis().x() << "," << back.axis().y() << ","
           << back.axis().z() << R"(], "angle": )" << back.angle() << "},";
  Run turned(with(rotation.str()));
  CHECK(turned.sensor(0) == Approx(kPi / 3).margin(1e-12));
  CHECK(turned.sensor(1) == Approx(kPi / 2).margin(1e-12));
  CHECK(turned.sensor(2) == Approx(0).margin(1e-12));
}

TEST_CASE("a drive acts while its joint acts", "[actuation]") {
  Run run(hinged_bar(R"json("off": 0.5, "drive": {"target": 1, "stiffness": 20})json"));
  test::run(*run.simulation, 0.6, 600);
  const Vec3<double> omega = run.simulation->state().v.segment<3>(3);
  test::run(*run.simulation, 0.5, 500);
  CHECK((run.simulation->state().v.segment<3>(3) - omega).norm() < 1e-9);
  CHECK(std::abs(run.simulation->ledger().balance) < 1e-8);
}

TEST_CASE("a force that reads the state keeps the order of each method", "[actuation]") {
  // A nonlinear oscillator with a coupled parameter: f = -40 sin(2 z) - 0.2 vz^3, and a radius that follows
  // z. The torque of the drive of a hinge depends on its angle, its rate and z.
  const std::string text = R"json({"gravity": [0, 0, 0],
    "parts": [{"name": "ball", "shape": "sphere", "mass": 3, "position": [0, 0, 0.5],
               "parameters": {"r": {"rest": 0.4, "stiffness": 300,
                                    "drive": {"target": "0.4 + 0.1 * ball.z", "stiffness": 200, "damping": 2}}}},
              {"name": "bar", "shape": "box", "parameters": {"a1": 0.5, "a2": 0.05, "a3": 0.05}, "mass": 2,
               "position": [3.5, 0, 0]}],
    "joints": [{"type": "hinge", "name": "pin", "from": {"part": "bar", "at": {"direction": [-1, 0, 0]}},
                "to": {"world": [3, 0, 0]}, "axis": [0, 1, 0],
                "drive": {"force": "4 * cos(pin.angle) - 0.3 * pin.rate + 5 * ball.z"}}],
    "tracks": [{"name": "top", "part": "ball", "at": {"direction": [0, 0, 1]}}],
    "forces": [{"part": "ball", "at": {"u": 0, "v": 0, "w": 0},
                "force": ["-2 * top.vz", 0, "-40 * sin(2 * ball.z) - 0.2 * ball.vz^3"]}]})json";
  auto state = [&](const std::string& method, int steps) {
    Run run(text, method);
    test::run(*run.simulation, 0.5, steps);
    VecX<double> x(run.simulation->state().q.size() + run.simulation->state().v.size());
    x << run.simulation->state().q, run.simulation->state().v;
    return x;
  };
  const VecX<double> exact = state("dop853", 2000);
  const std::vector<std::pair<std::string, double>> orders{
      {"semi_implicit_euler", 1}, {"implicit_midpoint", 2}, {"rk4", 4}, {"dormand_prince", 5}, {"esdirk", 4},
      {"linearly_implicit", 1}};
  for (const auto& [method, order] : orders) {
    std::vector<double> errors;
    for (const int steps : {32, 64, 128}) errors.push_back((state(method, steps) - exact).norm());
    CAPTURE(method, errors);
    CHECK(test::observed_order(errors) > order - 0.3);
  }
}

TEST_CASE("a muscle conserves momenta, and the ledger has its work", "[actuation]") {
  Run run(R"json({"gravity": [0, 0, 0],
    "parts": [{"name": "one", "shape": "sphere", "parameters": {"r": 0.2}, "angular_velocity": [1, 0, 2]},
              {"name": "two", "shape": "box", "position": [1, 0.2, 0], "velocity": [0, 0.5, 0]}],
    "springs": [{"name": "muscle", "from": {"part": "one", "at": {"direction": [1, 0, 0]}},
                 "to": {"part": "two", "at": {"direction": [-1, 0, 0]}},
                 "stiffness": "300 * (1 + 0.5 * sin(9 * t))", "damping": "2 + muscle.rate^2",
                 "rest_length": "0.5 + 0.2 * sin(5 * t) - 0.1 * one.vx"}]})json",
          "dormand_prince", 1e-10);
  const Ledger start = run.simulation->ledger();
  run.simulation->step(2);
  const Ledger end = run.simulation->ledger();
  CHECK((end.momentum - start.momentum).norm() < 1e-9);
  CHECK((end.angular_momentum - start.angular_momentum).norm() < 1e-8);
  CHECK(end.springs == 0);
  CHECK(std::abs(end.work[static_cast<int>(Work::actuation)]) > 1);
  CHECK(std::abs(end.balance) < 1e-7);
}

TEST_CASE("sensors may read sensors before them, and names with blanks are written in apostrophes",
          "[actuation]") {
  Run run(R"json({"gravity": [0, 0, 0],
    "parts": [{"name": "left wing", "shape": "sphere", "position": [1, 2, 3], "velocity": [0, 0, 4]},
              {"name": "frame", "shape": "box", "motion": {"position": ["5 * t", 0, 9]}}],
    "sensors": [{"name": "height", "value": "'left wing'.z"}, {"name": "twice", "value": "2 * height + t"},
                {"name": "speed", "value": "'left wing'.vz - frame.vx"}, {"name": "time", "value": "t^2"}]})json");
  CHECK(run.sensor(0) == 3);
  CHECK(run.sensor(1) == 6);
  CHECK(run.sensor(2) == -1);
  run.simulation->step(0.5);
  CHECK(run.sensor(1) == Approx(2 * 5 + 0.5));
  CHECK(run.sensor(3) == 0.25);
}

TEST_CASE("faulty names in formulas are reported with the names that exist", "[actuation]") {
  auto with_force = [](const std::string& formula) {
    return R"json({"parts": [{"name": "ball", "shape": "sphere"}],
      "forces": [{"part": "ball", "at": {"u": 0, "v": 0, "w": 0}, "force": [")json" +
           formula + R"json(", 0, 0]}]})json";
  };
  using test::has_text;
  CHECK_THAT(messages_of(with_force("bal.z")),
             has_text("no part, joint, spring, track, sensor or input \"bal\""));
  CHECK_THAT(messages_of(with_force("ball.height")), has_text("\"ball\" has no quantity \"height\""));
  CHECK_THAT(messages_of(with_force("ball.r")), has_text("\"ball\" has no quantity \"r\""));  // r is frozen
  CHECK_THAT(messages_of(with_force("2 * x")), has_text("unknown name \"x\""));
  CHECK_THAT(messages_of(with_force("ball.z +")), has_text("expected"));
  CHECK_THAT(messages_of(hinged_bar(R"json("limits": [1, -1])json")), has_text("lower < upper"));
  CHECK_THAT(messages_of(hinged_bar(R"json("limits": [-4, 4])json")),
             has_text("less than one turn minus 0.1 rad"));
  CHECK_THAT(messages_of(hinged_bar("", R"json("sensors ": [])json")), has_text("sensors"));
}

TEST_CASE(
    "a load connects its part with a part whose state it reads, and adds no joint coordinates to the model",
    "[actuation][skip]") {
  Run run(
      R"json({"parts": [{"name": "a", "shape": "sphere"}, {"name": "b", "shape": "sphere", "position": [9, 0, 0]},
                            {"name": "c", "shape": "sphere", "position": [19, 0, 0]}],
    "forces": [{"part": "a", "at": {"u": 0, "v": 0, "w": 0}, "force": ["b.x", 0, 0]}]})json");
  const Model& model = run.simulation->model();
  CHECK(model.load_connections() == std::vector<std::pair<int, int>>{{0, 1}});
  CHECK(model.loaded_parts() == std::vector<int>{0, 1});
  DisjointSets sets = model.connected_parts();
  CHECK(sets.root(0) == sets.root(1));
  CHECK(sets.root(0) != sets.root(2));
  CHECK(model.coordinates().empty());
}

}  // namespace actuation_scenes_test
