// Rings of point-to-point joints: their names and points, and the relative orientation that they fix. A ring
// of three points has nine rows for the six relative motions of two rigid parts. These rows are solved as
// exactly as the six rows of a weld, also if the joints are open at the start.
#include <cmath>
#include <memory>
#include <string>

#include <Eigen/Geometry>

#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"
#include "scene_run.h"

namespace rings_test {

using namespace pliant;
using test::messages_of;

namespace {

std::unique_ptr<Scene> scene_of(const std::string& text) {
  Diagnostics diagnostics;
  auto scene = parse_scene("ring.json", text, {}, diagnostics);
  CHECK(diagnostics.text().empty());
  return scene;
}

const PartModel& part_named(const Model& model, const std::string& name) {
  for (const PartModel& m : model.parts())
    if (m.part->name() == name) return m;
  throw std::invalid_argument(name);
}
Vec3<double> position(const Simulation& simulation, const std::string& name) {
  return simulation.state().q.segment<3>(part_named(simulation.model(), name).q0);
}
Eigen::Quaterniond orientation(const Simulation& simulation, const std::string& name) {
  const Vec<double, 4> q = simulation.state().q.segment<4>(part_named(simulation.model(), name).q0 + 3);
  return {q[0], q[1], q[2], q[3]};
}
/// Returns the angle between the orientations of two parts, rad.
double angle_between(const Simulation& simulation, const std::string& a, const std::string& b) {
  return orientation(simulation, a).angularDistance(orientation(simulation, b));
}
/// Returns the widest gap of all joints, m.
double widest_gap(const Simulation& simulation) {
  double widest = 0;
  for (int j = 0; j < static_cast<int>(simulation.model().joints().size()); ++j)
    widest = std::max(widest, simulation.model().gap(simulation.state(), j));
  return widest;
}

/// Returns the place of a point of a part at rest, m, in the frame of the part.
Vec3<double> place_at_rest(const Point& point) {
  return point.part->s({point.material}, point.part->parameters().rest()).col(0);
}

/// Returns a scene of two rigid parts that swing on a ball joint. joint: the joint between the parts.
std::string double_bar(const std::string& joint) {
  return R"json({"parts": [
      {"name": "upper", "shape": "box", "parameters": {"a1": 0.2, "a2": 0.15, "a3": 0.4}, "position": [0, 0, 1.6],
       "orientation": {"axis": [0, 1, 0], "angle": 0.0}, "angular_velocity": [1, 2, 0.5]},
      {"name": "lower", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.2, "a3": 0.4}, "position": [0, 0, 0.9]}],
    "joints": [
      {"type": "ball", "from": {"part": "upper", "at": {"direction": [0, 0, 1]}}, "to": {"world": [0, 0, 2]}}, )json" +
         joint + "]}";
}
const std::string kEnds =
    R"json("from": {"part": "lower", "at": {"near": [0, 0, 0.35]}}, "to": {"part": "upper", "at": {"near": [0, 0, -0.35]}})json";

/// Returns a scene of two solids far apart, rotated by an angle (rad) relative to each other, with a ring of
/// joints between them. a3: value of the parameter a3 of one solid.
std::string scattered(double angle, const std::string& a3) {
  return R"json({"gravity": [0, 0, 0], "stabilization": {"rate": 6},
    "parts": [
      {"name": "base", "shape": "superellipsoid", "parameters": {"a1": 0.4, "a2": 0.4, "a3": )json" +
         a3 + R"json(}, "beta": 0.02},
      {"name": "belly", "shape": "ellipsoid", "parameters": {"a1": 0.3, "a2": 0.3, "a3": 0.3},
       "position": [0.3, -0.5, 1.5], "orientation": {"axis": [1, 0.4, 0.3], "angle": )json" +
         std::to_string(angle) + R"json(}}],
    "joints": [{"type": "ball", "name": "waist", "from": {"part": "belly", "at": {"near": [0, 0, -0.2]}},
                "to": {"part": "base", "at": {"near": [0, 0, 0.3]}}, "ring": {"count": 3, "radius": 0.12},
                "rotation": {"axis": [0, 0, 1], "angle": 0}}]})json";
}

}  // namespace

TEST_CASE("a ring makes ball joints NAME.1, NAME.2, ... on equal circles in both parts", "[ring]") {
  const auto scene =
      scene_of(double_bar(R"json({"type": "ball", "name": "neck", )json" + kEnds +
                          R"json(, "ring": {"count": 4, "radius": 0.08, "axis": [0, 0, 2]}})json"));
  const Simulation simulation(scene->body, "rk4");
  const auto& joints = simulation.model().joints();
  REQUIRE(joints.size() == 5);
  for (std::size_t k = 0; k < 4; ++k) {
    const Joint& joint = *joints[k + 1].joint;
    CHECK(joint.name() == "neck." + std::to_string(k + 1));
    CHECK(joint.type() == std::string("ball"));
    CHECK(simulation.model().gap(simulation.state(), static_cast<int>(k + 1)) <= 1e-15);
    // The axis of the ring is along z, and the direction from the axis to the first point is along x.
    const double angle = kPi / 2 * static_cast<double>(k);
    const Vec3<double> offset(0.08 * std::cos(angle), 0.08 * std::sin(angle), 0);
    CHECK((place_at_rest(joint.points()[0]) - Vec3<double>(0, 0, 0.35) - offset).norm() <= 1e-15);
    CHECK((place_at_rest(joint.points()[1]) - Vec3<double>(0, 0, -0.35) - offset).norm() <= 1e-15);
  }
}

TEST_CASE("a ring with a tilted axis is a circle perpendicular to the axis", "[ring]") {
  const auto scene =
      scene_of(double_bar(R"json({"type": "ball", "name": "neck", )json" + kEnds +
                          R"json(, "ring": {"count": 5, "radius": 0.06, "axis": [1, 1, 1]}})json"));
  const Vec3<double> axis = Vec3<double>::Constant(1 / std::sqrt(3.0));
  int points = 0;
  for (const auto& joint : scene->body.joints()) {
    if (joint->name().rfind("neck.", 0) != 0) continue;
    ++points;
    const Vec3<double> offset = place_at_rest(joint->points()[1]) - Vec3<double>(0, 0, -0.35);
    CHECK(offset.norm() == Approx(0.06).epsilon(1e-13));
    CHECK(std::abs(offset.dot(axis)) <= 1e-15);
  }
  CHECK(points == 5);
}

TEST_CASE(
    "rings that cannot close or fix the orientation are refused: tiny rings, unequal rings of rigid shells",
    "[ring]") {
  const auto ring = [](const char* radius) {
    return R"json({"type": "ball", "name": "neck", )json" + kEnds +
           R"json(, "ring": {"count": 3, "radius": )json" + radius + "}}";
  };
  CHECK_THAT(messages_of(double_bar(ring("1e-6"))), test::has_text("expected a radius of at least"));
  CHECK(messages_of(double_bar(ring("1e-5"))).empty());
  const auto shells = [](const std::string& of_lower) {
    return R"json({"parts": [
      {"name": "upper", "shape": "ellipsoid", "shell": true, "density": 5,
       "parameters": {"a1": 0.4, "a2": 0.4, "a3": 0.2}, "position": [0, 0, 1.6]},
      {"name": "lower", "shape": "ellipsoid", "shell": true, "density": 5, "parameters": {)json" +
           of_lower + R"json(}, "position": [0, 0, 1.0]}],
     "joints": [{"type": "ball", "name": "neck", "from": {"part": "lower", "at": {"direction": [0, 0, 1]}},
       "to": {"part": "upper", "at": {"direction": [0, 0, -1]}}, "ring": {"count": 3, "radius": 0.1}}]})json";
  };
  CHECK_THAT(messages_of(shells(R"json("a1": 0.2, "a2": 0.4, "a3": 0.4)json")),
             test::has_text("No motion of rigid parts closes the ring"));
  CHECK(messages_of(shells(R"json("a1": 0.4, "a2": 0.4, "a3": 0.2)json")).empty());
  CHECK_THAT(messages_of(
                 double_bar(R"json({"type": "ball", "name": "neck.2", )json" + kEnds + "}, " + ring("0.08"))),
             test::has_text("name given twice"));
}

TEST_CASE("three points connect two rigid parts as a weld does", "[ring]") {
  const auto held = [&](const std::string& joint) {
    const auto scene = scene_of(double_bar(joint));
    auto simulation = std::make_unique<Simulation>(scene->body, "dop853", 1, 1e-12);
    while (simulation->time() < 2) simulation->step_up_to(2);
    return std::make_tuple(position(*simulation, "lower"), orientation(*simulation, "lower"),
                           widest_gap(*simulation));
  };
  const auto weld = held(R"json({"type": "weld", )json" + kEnds + "}");
  for (const int count : {3, 4, 7}) {
    CAPTURE(count);
    const auto ring =
        held(R"json({"type": "ball", "name": "neck", )json" + kEnds + R"json(, "ring": {"count": )json" +
             std::to_string(count) + R"json(, "radius": 0.08}})json");
    CHECK((std::get<0>(ring) - std::get<0>(weld)).norm() <= 1e-9);
    CHECK(std::get<1>(ring).angularDistance(std::get<1>(weld)) <= 1e-9);
    CHECK(std::get<2>(ring) <= 1e-12);
  }
}

TEST_CASE("two points are a hinge about the line through them", "[ring]") {
  const auto scene = scene_of(double_bar(R"json({"type": "ball", "name": "elbow", )json" + kEnds +
                                         R"json(, "ring": {"count": 2, "radius": 0.08}})json"));
  Simulation simulation(scene->body, "rk4", 1);
  double turned = 0;
  for (int i = 0; i < 1000; ++i) {
    simulation.step(0.002);
    const Eigen::Quaterniond relative =
        orientation(simulation, "upper").conjugate() * orientation(simulation, "lower");
    turned = std::max(turned, relative.angularDistance(Eigen::Quaterniond::Identity()));
    CHECK((relative * Vec3<double>::UnitX() - Vec3<double>::UnitX()).norm() <= 1e-9);
  }
  CHECK(turned > 0.03);
}

TEST_CASE("a ring closes from an open, rotated start and then keeps the orientation", "[ring]") {
  for (const char* a3 : {"0.35", R"json({"rest": 0.35, "stiffness": 3000, "initial": 0.3})json"})
    for (const double angle : {0.0, 0.5, 1.5, 2.5, 3.0}) {
      CAPTURE(a3, angle);
      const auto scene = scene_of(scattered(angle, a3));
      Simulation simulation(scene->body, "rk4", 1);
      while (simulation.time() < 6) simulation.step(0.002);
      CHECK(widest_gap(simulation) <= 1e-12);
      CHECK(angle_between(simulation, "base", "belly") <= 1e-9);
      for (const JointMode mode : simulation.state().joints) CHECK(mode == JointMode::closed);
    }
}

}  // namespace rings_test
