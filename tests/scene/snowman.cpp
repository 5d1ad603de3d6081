// The paper's Fig. 5: twelve point-to-point joints assemble a snowman and keep it together. The snowman hops
// along a prescribed path by changes of its own shape and then stands still.
#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include <pliant/scene/read_scene.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"
#include "deepest.h"

namespace snowman_test {

using namespace pliant;

namespace {

/// Times at which the snowman is assembled, and at which it has landed, s. Then it begins to hop.
constexpr double kAssembled = 3.1, kLanded = 4.9;

Vec3<double> position(const Simulation& simulation, int part) {
  return simulation.state().q.segment<3>(simulation.model().parts()[static_cast<std::size_t>(part)].q0);
}
/// Returns the pairs of parts that joints connect, by their numbers.
std::set<std::pair<int, int>> joined_pairs(const Model& model) {
  std::set<std::pair<int, int>> pairs;
  for (const JointModel& joint : model.joints())
    pairs.insert(std::minmax(joint.sides[0].part, joint.sides[1].part));
  return pairs;
}

/// Returns the deepest overlap of the surfaces of each joined pair, m; positive. simulation: a simulation in
/// which joined parts may touch. state: state of the snowman; t: its time, s.
std::map<std::pair<int, int>, double> overlaps_of_joined(const Simulation& simulation, const State& state,
                                                         double t) {
  std::map<std::pair<int, int>, double> deepest;
  for (const auto& pair : joined_pairs(simulation.model())) deepest[pair] = 0;
  for (const Contact& contact : simulation.contact()->overlaps(state, t)) {
    const auto found = deepest.find(std::minmax(contact.a.part, contact.b.part));
    if (found != deepest.end()) found->second = std::max(found->second, -contact.gap);
  }
  return deepest;
}

/// Returns the angle between the axis of the base and the vertical, rad.
double tilt(const Simulation& simulation) {
  const Vec<double, 4> q = simulation.state().q.segment<4>(simulation.model().parts()[0].q0 + 3);
  return std::acos(std::min(1.0, 1 - 2 * (q[1] * q[1] + q[2] * q[2])));
}

}  // namespace

TEST_CASE("the snowman assembles itself by twelve point joints and hops along its path", "[joints][long]") {
  Diagnostics diagnostics;
  const auto scene = read_scene(std::string(PLIANT_SCENES) + "/snowman.json", {}, diagnostics);
  Simulation simulation(scene->body, scene->integrator, 1, scene->tolerance);
  const Model& model = simulation.model();

  // Twelve point-to-point joints connect the parts. The drives of three parameters of the base move the
  // snowman; springs in the joints of hat, nose and arms keep the orientations of these parts. There is no
  // other spring, force or torque, and no prescribed motion.
  REQUIRE(model.joints().size() == 12);
  for (const JointModel& joint : model.joints()) {
    CHECK(joint.joint->type() == std::string("ball"));
    CHECK(joint.sides.size() == 2);
  }
  CHECK(model.springs().empty());
  CHECK(model.forces().empty());
  CHECK(model.torques().empty());
  CHECK(model.distributed_forces().empty());
  std::set<std::string> of_parameters, of_joints;
  for (const DriveModel& drive : model.drives()) {
    const std::string& name = drive.drive->name;
    if (drive.drive->is_passive())
      of_joints.insert(name.substr(0, name.find('.')));
    else
      of_parameters.insert(name);
  }
  CHECK(of_parameters == std::set<std::string>{"base.a3", "base.shear.sx", "base.shear.sy"});
  CHECK(of_joints == std::set<std::string>{"hat", "nose", "shoulder_left", "shoulder_right"});
  for (const PartModel& part : model.parts()) {
    CHECK(part.q0 >= 0);
    CHECK(part.n_s > 0);
  }

  // Assembly: parts that no joint connects do not overlap. Joined parts overlap in their final positions,
  // like the hat and the head. During the assembly, their overlap exceeds the final overlap by at most 1 mm,
  // and their distance is at most 1 mm less than the final distance.
  const auto touching = read_scene(std::string(PLIANT_SCENES) + "/snowman.json", {}, diagnostics);
  for (const auto& [a, b] : joined_pairs(model)) {
    ContactPair pair;
    pair.a = model.parts()[static_cast<std::size_t>(a)].part->name();
    pair.b = model.parts()[static_cast<std::size_t>(b)].part->name();
    touching->body.contact.pairs.push_back(pair);
  }
  const Simulation with_joined(touching->body, touching->integrator, 1, touching->tolerance);
  double overlap = 0;
  std::map<std::pair<int, int>, double> deepest, nearest;
  const auto distance = [&](const std::pair<int, int>& pair) {
    return (position(simulation, pair.first) - position(simulation, pair.second)).norm();
  };
  for (int step = 0; simulation.time() < kAssembled; ++step) {
    simulation.step(scene->step);
    overlap = std::max(overlap, test::deepest_overlap(simulation));
    if (step % 5 != 0) continue;
    for (const auto& [pair, depth] : overlaps_of_joined(with_joined, simulation.state(), simulation.time())) {
      deepest[pair] = std::max(deepest[pair], depth);
      const double now = distance(pair);
      nearest[pair] = std::min(nearest.emplace(pair, now).first->second, now);
    }
  }
  CHECK(overlap <= 1e-6);
  const auto at_seat = overlaps_of_joined(with_joined, simulation.state(), simulation.time());
  CHECK(at_seat.size() == 8);
  for (const auto& [pair, depth] : at_seat) {
    CAPTURE(pair.first, pair.second, depth, deepest[pair], nearest[pair], distance(pair));
    CHECK(depth > 0);
    CHECK(deepest[pair] <= depth + 0.001);
    CHECK(nearest[pair] >= distance(pair) - 0.001);
  }
  for (const JointMode mode : simulation.state().joints) CHECK(mode == JointMode::closed);
  CHECK(simulation.contact()->contacts().empty());

  // The snowman drops and then hops: at least six flights, along the path y = 0.35 sin(2.618 x) to x = 2.4.
  int hops = 0;
  double path_error = 0, largest_tilt = 0, since = -1, airborne = 0;
  while (simulation.time() < scene->end - 0.5 * scene->step) {
    simulation.step(scene->step);
    if (simulation.time() < kLanded) continue;
    const Vec3<double> c = position(simulation, 0);
    path_error = std::max(path_error, std::abs(c[1] - 0.35 * std::sin(2.618 * c[0])));
    largest_tilt = std::max(largest_tilt, tilt(simulation));
    if (!simulation.contact()->contacts().empty())
      since = -1;
    else if (since < 0)
      since = simulation.time();
    else if (simulation.time() - since > 0.1 && simulation.time() - since <= 0.1 + scene->step)
      ++hops;
    airborne += simulation.contact()->contacts().empty() ? scene->step : 0;
  }
  CAPTURE(path_error, largest_tilt, airborne);
  CHECK(hops >= 6);
  CHECK(airborne >= 2);
  CHECK(path_error <= 0.1);
  CHECK(largest_tilt <= 0.25);
  // The snowman stands upright and still at the end of the path.
  CHECK(std::abs(position(simulation, 0)[0] - 2.4) <= 0.05);
  CHECK(tilt(simulation) <= 0.01);
  CHECK(simulation.state().v.segment<3>(model.parts()[0].v0).norm() <= 0.01);
}

}  // namespace snowman_test
