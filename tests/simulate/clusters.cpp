// Clusters of bodies step separately. A cluster has the same bits alone and beside other clusters. Bodies
// that meet join one cluster. include/pliant/simulate/README.md explains clusters and their intervals.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <pliant/body/joints/all_joints.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/math/index.h>
#include <pliant/simulate/clusters.h>
#include <pliant/simulate/partial_state.h>

#include "motion.h"

namespace clusters_test {

using namespace pliant;

namespace {

Part& ball(MultiBody& body, const std::string& name, const Vec3<double>& place,
           const Vec3<double>& velocity = Vec3<double>::Zero()) {
  return body.add<Primitive<Sphere>>(name).rest({{"r", 0.1}}).place(place).velocity(velocity, {0, 0, 0});
}

void add_floor(MultiBody& body, double friction, double restitution) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  body.contact.friction = friction;
  body.contact.restitution = restitution;
}

/// Adds two boxes that fall, meet and tumble, near x (m).
void add_tumblers(MultiBody& body, double x) {
  for (const int i : {0, 1})
    body.add<Primitive<Box>>("box" + std::to_string(i))
        .rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}})
        .place({x + 0.45 * i, 0.05 * i, 0.5 + 0.1 * i},
               Eigen::Quaterniond(Eigen::AngleAxisd(0.4 + i, Vec3<double>(1, 2, 0.5).normalized())))
        .velocity({i == 0 ? 1.0 : -1.0, 0, 0}, {1, 2, 3});
}

/// Adds balls that fall from several heights, far from each other and from everything else. With nine balls
/// or more, the parts of the model step in clusters.
void add_falling_balls(MultiBody& body, int n, double height = 0.15) {
  for (int i = 0; i < n; ++i)
    ball(body, "ball" + std::to_string(i), {2.0 + i, 3, height + 0.03 * i}, {0.1 * i, 0, 0});
}

/// Returns the clusters of more than one part.
std::vector<std::vector<int>> groups(const Simulation& simulation) {
  std::vector<std::vector<int>> groups = simulation.clusters()->parts();
  groups.erase(
      std::remove_if(groups.begin(), groups.end(), [](const auto& parts) { return parts.size() == 1; }),
      groups.end());
  return groups;
}

/// Adds two pendulums and a ball on a spring to one fixed ball, and a fixed table with a box that slides.
void add_machine(MultiBody& body) {
  const Part& hub = ball(body, "hub", {30, 0, 2}).fix();
  for (const int i : {0, 1}) {
    const double side = i == 0 ? 1 : -1;
    const Part& bob = ball(body, "bob" + std::to_string(i), {30 + 0.2 * side, 0, 2}, {0, 0.3 + 0.2 * i, 0});
    body.ball("pivot" + std::to_string(i), point(hub, 0, i * kPi), point(bob, 0, (1 - i) * kPi));
  }
  body.spring("spring", point(hub, -kPi / 2, 0), point(ball(body, "hung", {30, 0, 1.2}), kPi / 2, 0), 50, 0.1,
              0.4);
  body.add<Primitive<Box>>("table").rest({{"a1", 1}, {"a2", 1}, {"a3", 0.1}}).place({30, 9, 1}).fix();
  body.add<Primitive<Box>>("slider")
      .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
      .place({30, 9, 1.2})
      .velocity({1, 0, 0}, {0, 0, 0});
  body.contact.groups.push_back({"bobs", {"bob0", "bob1"}});
  body.contact.pairs.push_back({"bobs", "bobs", true, 0.1, 0.9});
  body.contact.pairs.push_back({"slider", "table", true, 0.2});
}

/// A method and a tolerance.
struct Way {
  const char* integrator;
  double tolerance;
};
const Way kWays[] = {{"auto", 1e-3}, {"dormand_prince", 1e-5}, {"dop853", 1e-7}};

void advance_to(Simulation& simulation, double end) {
  while (simulation.time() < end) simulation.step_up_to(end);
}

/// Returns q and v of a part.
VecX<double> coordinates(const Simulation& simulation, const std::string& name) {
  const Model& model = simulation.model();
  const int i = model.body().index(*model.body().find(name));
  const PartModel& m = model.parts()[static_cast<std::size_t>(i)];
  VecX<double> all(m.n_q() + m.n_v());
  all << simulation.state().q.segment(m.q0, m.n_q()), simulation.state().v.segment(m.v0, m.n_v());
  return all;
}

}  // namespace

TEST_CASE("a cluster has the same bits beside any others, in any order", "[clusters]") {
  for (const Way& way : kWays) {
    INFO(way.integrator << " " << way.tolerance);
    MultiBody few, many, reversed;
    for (MultiBody* body : {&few, &many, &reversed}) add_floor(*body, 0.3, 0.4);
    ball(few, "witness", {-9, 0, 5});
    add_tumblers(few, 0);
    add_machine(few);
    add_falling_balls(few, 7, 0.4);
    add_tumblers(many, 0);
    add_machine(many);
    ball(many, "witness", {-9, 0, 5});
    add_falling_balls(many, 12);
    add_falling_balls(reversed, 12);
    ball(reversed, "witness", {-9, 0, 5});
    add_machine(reversed);
    add_tumblers(reversed, 0);
    Simulation one(few, way.integrator, 1, way.tolerance), two(many, way.integrator, 1, way.tolerance),
        three(reversed, way.integrator, 1, way.tolerance);
    for (Simulation* simulation : {&one, &two, &three}) advance_to(*simulation, 0.6);
    REQUIRE(two.clusters() != nullptr);
    CHECK(two.clusters()->parts().size() >= 13);
    for (int joint = 0; joint < 2; ++joint) CHECK(two.model().gap(two.state(), joint) < 1e-12);
    // The slider stops after v^2 / (2 mu g) on the table.
    CHECK(std::abs(coordinates(two, "slider")[0] - 30 - 1 / (2 * 0.2 * 9.81)) < 0.1 * way.tolerance);
    for (const char* name : {"box0", "box1", "witness", "bob0", "bob1", "hung", "slider"}) {
      INFO(name);
      CHECK(coordinates(one, name) == coordinates(two, name));
      CHECK(coordinates(one, name) == coordinates(three, name));
    }
  }
}

TEST_CASE("impact times are found for any number of bodies", "[clusters]") {
  // A ball that falls from height H over the floor bounces at sqrt(2 H / g) (1 + 2 e + 2 e^2 + ...).
  constexpr double e = 0.6, g = 9.81, end = 0.6;
  auto height = [&](double H, double t) {
    double begin = std::sqrt(2 * H / g), speed = g * begin;
    if (t < begin) return H - 0.5 * g * t * t;
    for (;;) {
      speed *= e;
      const double flight = 2 * speed / g;
      if (t < begin + flight) return speed * (t - begin) - 0.5 * g * (t - begin) * (t - begin);
      begin += flight;
    }
  };
  for (const double tolerance : {1e-2, 1e-4, 1e-7}) {
    INFO(tolerance);
    MultiBody body;
    add_floor(body, 0, e);
    constexpr int n = 20;
    for (int i = 0; i < n; ++i) ball(body, "ball" + std::to_string(i), {0.5 * i, 0, 0.3 + 0.02 * i});
    Simulation simulation(body, "auto", 1, tolerance);
    advance_to(simulation, end);
    for (int i = 0; i < n; ++i)
      CHECK(std::abs(coordinates(simulation, "ball" + std::to_string(i))[2] - 0.1 -
                     height(0.2 + 0.02 * i, simulation.time())) < 1e-11);
    CHECK(simulation.step_counters().impacts > n);
    CHECK(simulation.step_counters().uncontrolled == 0);
  }
}

TEST_CASE("bodies that meet although they were predicted not to meet join one cluster", "[clusters]") {
  // Both balls start at rest. Within an interval, a strong spring pulls the driver to the target.
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  body.contact.restitution = 1;
  body.contact.interval = 0.25;
  Part& driver = ball(body, "driver", {0, 0, 0});
  ball(body, "target", {0.5, 0, 0});
  ball(body, "far", {9, 9, 9});
  add_falling_balls(body, 7);  // without gravity, they keep their horizontal velocities
  body.spring("pull", point(driver, 0, 0, 0), world(0.6, 0, 0), 1e3);
  Simulation simulation(body, "auto", 1, 1e-8);
  simulation.step_up_to(0.25);
  CHECK(simulation.time() == 0.25);
  CHECK(groups(simulation) == std::vector<std::vector<int>>{{0, 1}});
  const double mass = simulation.model().parts()[0].part->total_mass(), rate = std::sqrt(1e3 / mass);
  // The driver meets the target at x = 0.3 m, halfway to the anchor of the spring, and they exchange their
  // velocities.
  const double speed = 0.6 * rate * std::sin(std::acos(0.5));
  CHECK(simulation.step_counters().impacts >= 1);
  CHECK(std::abs(coordinates(simulation, "target")[7] - speed) < 1e-6 * speed);
  CHECK(coordinates(simulation, "far").head<3>() == Vec3<double>(9, 9, 9));
}

TEST_CASE("a part with prescribed motion is in the cluster of a body that it reaches", "[clusters]") {
  for (const Way& way : kWays) {
    INFO(way.integrator << " " << way.tolerance);
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    body.contact.friction = 0;
    PrescribedMotion motion;
    motion.position = {TimeFunction::formula("t"), 0, 0};
    ball(body, "pushed", {0.3, 0, 0});
    ball(body, "apart", {0, 5, 0});
    add_falling_balls(body, 7);
    ball(body, "pusher", {0, 0, 0}).prescribe(motion);
    Simulation simulation(body, way.integrator, 1, way.tolerance);
    advance_to(simulation, 0.5);
    const VecX<double> pushed = coordinates(simulation, "pushed");
    CHECK(std::abs(pushed[0] - 0.7) < 1e-6);
    CHECK(std::abs(pushed[7] - 1) < 1e-9);
    CHECK(coordinates(simulation, "apart").head<3>() == Vec3<double>(0, 5, 0));
  }
}

TEST_CASE("a resumed state continues with the same bits", "[clusters][long]") {
  for (const Way& way : kWays)
    for (const double stop : {0.11, 0.3}) {  // in flight, and with contacts
      INFO(way.integrator << " " << way.tolerance << " at " << stop);
      MultiBody body, again;
      for (MultiBody* each : {&body, &again}) {
        add_floor(*each, 0.5, 0.2);
        add_tumblers(*each, each == &body ? 0 : 0.2);
        add_falling_balls(*each, 8, each == &body ? 0.15 : 0.2);
        each->contact.sleep = Sleep{1e-2, 0.05};
      }
      Simulation simulation(body, way.integrator, 1, way.tolerance);
      advance_to(simulation, stop);
      Simulation resumed(again, way.integrator, 1, way.tolerance);
      advance_to(resumed, 0.4);  // another motion, with other clusters
      resumed.set_state(simulation.state());
      for (Simulation* each : {&simulation, &resumed}) advance_to(*each, 0.8);
      CHECK(hash(simulation.state()) == hash(resumed.state()));
    }
}

TEST_CASE("sleeping clusters are not simulated, and wake when a body comes", "[clusters]") {
  MultiBody body;
  add_floor(body, 0.5, 0);
  body.contact.sleep = Sleep{1e-3, 0.02};
  ball(body, "sleeper", {0, 0, 0.1});
  ball(body, "other", {0.2, 0, 0.1});
  ball(body, "visitor", {-3, 0, 0.1}, {2, 0, 0});
  add_falling_balls(body, 7, 0.1);
  Simulation simulation(body, "auto", 1, 1e-4);
  advance_to(simulation, 0.5);
  // Part 2 is the visitor, which rolls. Parts 3 to 9 are the row of balls; all except the first roll.
  const std::vector<std::vector<int>> awake = simulation.clusters()->parts();
  CHECK(awake.front() == std::vector<int>{2});
  CHECK(awake.size() == 7);  // the first ball of the row sleeps
  const StepCounters before = simulation.step_counters();
  advance_to(simulation, 0.6);
  const StepCounters& after = simulation.step_counters();
  CHECK(after.steps - before.steps == 13);  // 13 intervals of 1/128 s end from 0.5 s to 0.6 s
  CHECK(after.rejected == before.rejected);
  advance_to(simulation, 2);
  // The same three balls alone, as one set of bodies.
  MultiBody alone;
  add_floor(alone, 0.5, 0);
  ball(alone, "sleeper", {0, 0, 0.1});
  ball(alone, "other", {0.2, 0, 0.1});
  ball(alone, "visitor", {-3, 0, 0.1}, {2, 0, 0});
  Simulation reference(alone, "auto", 1, 1e-4);
  advance_to(reference, 2);
  for (const char* name : {"sleeper", "other", "visitor"}) {
    INFO(name);
    CHECK(coordinates(simulation, name)[0] == Approx(coordinates(reference, name)[0]).margin(1e-4));
  }
  CHECK(coordinates(simulation, "other")[0] > 0.21);
}

TEST_CASE("a sleeping body that is hit still rests on the fixed body below it", "[clusters]") {
  MultiBody body;
  body.contact.active = true;
  body.contact.friction = 0.5;
  body.contact.sleep = Sleep{1e-3, 0.02};
  body.add<Primitive<Box>>("table").rest({{"a1", 5}, {"a2", 1}, {"a3", 0.1}}).place({0, 0, -0.1}).fix();
  for (const int i : {0, 1})  // the boxes do not touch, so that each sleeps alone
    body.add<Primitive<Box>>("box" + std::to_string(i))
        .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
        .place({0.2001 * i, 0, 0.1});
  ball(body, "shot", {-2.3, 0, 0.15}, {10, 0, -1});
  add_falling_balls(body, 7);
  Simulation simulation(body, "auto", 1, 1e-4);
  advance_to(simulation, 0.2);
  CHECK(sleeps(simulation.state(), 1));
  CHECK(sleeps(simulation.state(), 2));
  double lowest = 1;
  while (simulation.time() < 0.4) {
    simulation.step_up_to(0.4);
    for (const char* box : {"box0", "box1"}) lowest = std::min(lowest, coordinates(simulation, box)[2]);
  }
  CHECK(coordinates(simulation, "box1")[0] > 0.3);
  CHECK(lowest > 0.1 - 1e-5);
}

TEST_CASE("a state does not change if the data of some parts are extracted and inserted again",
          "[clusters]") {
  MultiBody body;
  add_floor(body, 0.5, 0);
  body.contact.sleep = Sleep{1e-3, 0.05};
  for (int i = 0; i < 4; ++i) ball(body, "row" + std::to_string(i), {0.19 * i, 0, 0.1});
  Part &one = ball(body, "one", {5, 0, 1}), &two = ball(body, "two", {5.3, 0, 1});
  body.ball("joint", point(one, 0, 0), point(two, kPi, 0));
  add_falling_balls(body, 7);
  Simulation simulation(body, "auto", 1, 1e-4);
  for (const double time : {0.03, 0.1}) {  // before and after the row falls asleep
    advance_to(simulation, time);
    const State& state = simulation.state();
    CHECK((state.contact_cache.size() > 1) == (time < 0.05));
    CHECK((state.at_rest[0] < 0) == (time > 0.05));
    for (const std::vector<int>& numbers : {std::vector<int>{0, 1, 2, 3}, {4, 5}}) {
      const Model some(body, numbers);
      CHECK(some.joints().size() == (numbers.size() == 2 ? 1 : 0));
      State part = some.initial_state(), back = state;
      extract_state(simulation.model(), state, some, part);
      CHECK(part.contact_cache.size() == (numbers.size() == 2 ? 0 : state.contact_cache.size()));
      // Clears the data that extract_state() has copied to `part`, and inserts them again.
      const PartModel& first = simulation.model().parts()[at(numbers[0])];
      back.q.segment(first.q0, part.q.size()).setZero();
      back.v.segment(first.v0, part.v.size()).setZero();
      for (const int i : numbers) back.at_rest[at(i)] = 7;
      if (numbers.size() == 4) back.contact_cache.clear();
      for (const int i : numbers) back.step_memory[at(i)] = {};
      std::fill(back.joints.begin(), back.joints.end(), JointMode::off);
      insert_state(some, part, simulation.model(), back);
      if (numbers.size() == 4) back.joints = state.joints;  // the joint belongs to other parts
      CHECK(hash(back) == hash(state));
    }
  }
  State mixed = simulation.state(), part = Model(body, {0, 1}).initial_state();
  mixed.step_memory[0] = {1e-3, 0.5, 1e-9, 3};
  mixed.step_memory[1] = {2e-3, 0.2, 1e-8, 4};
  extract_state(simulation.model(), mixed, Model(body, {0, 1}), part);
  CHECK(part.h == 1e-3);
  CHECK(part.error == 0.5);
  CHECK(part.contact_residual == 1e-8);
  CHECK(part.contact_cache_age == 4);
  mixed.step_memory[1].h = -1;
  CHECK_THROWS_AS(simulation.set_state(mixed), std::invalid_argument);
}

}  // namespace clusters_test
