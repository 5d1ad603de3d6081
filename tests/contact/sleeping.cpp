// Sleep of bodies at rest. The state of a sleeping body keeps all its bits, and the body is not evaluated.
// Impacts, and changes of the forces, joints and supports of a body, wake it.
#include "catch.h"

#include <algorithm>
#include <cmath>

#include <pliant/body/joints/string.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/primitive.h>
#include <pliant/shape/box.h>

#include "motion.h"

namespace sleeping_test {

using namespace pliant;

namespace {

constexpr double kStep = 2e-3;  // s

Part& cube(MultiBody& body, const std::string& name, const Vec3<double>& at) {
  Part& part = test::add(body, name, "box", {}, 500);
  part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place(at, Eigen::Quaterniond::Identity());
  return part;
}

/// Adds a tower of n cubes on a floor, and activates sleep.
void tower(MultiBody& body, int n) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  body.contact.sleep = Sleep{1e-3, 0.1};
  for (int i = 0; i < n; ++i) cube(body, "cube" + std::to_string(i), {0.01 * (i % 2), 0, 0.1 + 0.2 * i});
}

bool all_sleep(const Simulation& simulation) {
  const State& state = simulation.state();
  for (std::size_t i = 0; i < simulation.model().parts().size(); ++i)
    if (simulation.model().parts()[i].q0 >= 0 && !sleeps(state, static_cast<int>(i))) return false;
  return true;
}
bool none_sleeps(const Simulation& simulation) {
  const std::vector<double>& rest_times = simulation.state().at_rest;
  return std::none_of(rest_times.begin(), rest_times.end(), [](double time) { return time < 0; });
}

/// Steps until all bodies sleep. Requires that this takes at most 1 s.
void run_until_asleep(Simulation& simulation) {
  for (int i = 0; i < 500 && !all_sleep(simulation); ++i) simulation.step(kStep);
  REQUIRE(all_sleep(simulation));
}

/// Steps until no body sleeps, at most 20 times. Returns whether this is achieved.
bool wakes(Simulation& simulation) {
  for (int i = 0; i < 20; ++i) {
    simulation.step(kStep);
    if (none_sleeps(simulation)) return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a sleeping body keeps its state to the last bit, and is not evaluated", "[sleep][contact]") {
  for (const char* method : {"rk4", "semi_implicit_euler", "linearly_implicit"}) {
    MultiBody body;
    tower(body, 3);
    Simulation simulation(body, method);
    CHECK(none_sleeps(simulation));
    run_until_asleep(simulation);
    CHECK(simulation.time() == Approx(0.1).margin(1.5 * kStep));
    const State asleep = simulation.state();
    const Counters before = simulation.counters();
    for (int i = 0; i < 50; ++i) simulation.step(kStep);
    CHECK(simulation.state().q == asleep.q);
    CHECK(simulation.state().v.isZero(0));
    CHECK(simulation.state().at_rest == asleep.at_rest);
    if (std::string(method) != "linearly_implicit") {
      CHECK(simulation.counters().inertial_forces == before.inertial_forces);
      CHECK(simulation.counters().mass_matrices == before.mass_matrices);
    }
    CHECK(simulation.contact()->contacts().empty());
    CHECK(std::abs(simulation.ledger().balance) < 1e-9);
    // A run resumed from a stored state continues identically.
    MultiBody other;
    tower(other, 3);
    Simulation resumed(other, method);
    resumed.set_state(asleep);
    for (int i = 0; i < 50; ++i) resumed.step(kStep);
    CHECK(hash(resumed.state()) == hash(simulation.state()));
  }
}

TEST_CASE("bodies sleep only if sleep is active, and moving bodies stay awake", "[sleep][contact]") {
  MultiBody body;
  tower(body, 2);
  body.contact.sleep.reset();
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.3, 150);
  CHECK(simulation.state().at_rest.empty());

  MultiBody rolling;
  tower(rolling, 1);
  Part& ball = test::add(rolling, "ball", "sphere", {}, 500);
  ball.rest({{"r", 0.1}}).place({2, 0, 0.1}, Eigen::Quaterniond::Identity()).velocity({0.5, 0, 0}, {0, 5, 0});
  Simulation both(rolling, "rk4");
  test::run(both, 0.3, 150);
  CHECK(sleeps(both.state(), 0));
  CHECK_FALSE(sleeps(both.state(), 1));
  CHECK(both.state().v[6] == Approx(0.5).epsilon(1e-6));
}

TEST_CASE("a body that falls on sleeping ones wakes all of them, and the motion is the same as without sleep",
          "[sleep][contact]") {
  VecX<double> end[2];
  for (const bool sleep : {false, true}) {
    MultiBody body;
    tower(body, 3);
    if (!sleep) body.contact.sleep.reset();
    // The ball falls for 0.5 s.
    Part& ball = test::add(body, "ball", "sphere", {}, 2000);
    ball.rest({{"r", 0.1}}).place({0.05, 0, 0.7 + 0.5 * 9.81 * 0.25}, Eigen::Quaterniond::Identity());
    Simulation simulation(body, "rk4");
    bool slept = false, woke = false;
    for (int i = 0; i < 300; ++i) {
      simulation.step(kStep);
      const bool tower_sleeps = sleeps(simulation.state(), 0) && sleeps(simulation.state(), 2);
      woke = woke || (slept && !tower_sleeps);
      slept = slept || tower_sleeps;
    }
    CHECK(slept == sleep);
    CHECK(woke == sleep);
    end[sleep ? 1 : 0] = simulation.state().q;
  }
  CHECK((end[1] - end[0]).lpNorm<Eigen::Infinity>() < 1e-4);
}

TEST_CASE("a changing load wakes a sleeping body", "[sleep][contact]") {
  const TimeFunction late = TimeFunction::formula("50 * min(max((t - 0.5) / 0.01, 0), 1)");
  auto wakes_at_half = [](MultiBody& body) {
    Simulation simulation(body, "rk4");
    run_until_asleep(simulation);
    while (simulation.time() < 0.497) simulation.step(kStep);
    CHECK(all_sleep(simulation));
    Simulation resumed(body, "rk4");
    resumed.set_state(simulation.state());
    const bool woke = wakes(simulation);
    while (resumed.time() < simulation.time() - 0.5 * kStep) resumed.step(kStep);
    CHECK(hash(resumed.state()) == hash(simulation.state()));
    return woke;
  };
  SECTION("a force") {
    MultiBody body;
    tower(body, 2);
    body.force("push", point(*body.parts()[1], 0, 0), TimeVector(late, 0., 0.));
    CHECK(wakes_at_half(body));
  }
  SECTION("a torque") {
    MultiBody body;
    tower(body, 2);
    body.torque("turn", *body.parts()[0], TimeVector(0., 0., late));
    CHECK(wakes_at_half(body));
  }
  SECTION("the reaction of a torque") {
    MultiBody body;
    tower(body, 2);
    Part& post = cube(body, "post", {3, 0, 1}).fix();
    body.torque("turn", post, TimeVector(0., 0., late)).against = body.parts()[0].get();
    CHECK(wakes_at_half(body));
  }
  SECTION("a part with prescribed motion that rotates the axes of a torque's reaction") {
    MultiBody body;
    tower(body, 2);
    PrescribedMotion motion;
    motion.position = Vec3<double>(3, 0, 1);
    motion.axis = {1, 0, 0};
    motion.angle = late;
    Part& hand = cube(body, "hand", {3, 0, 1}).prescribe(motion);
    body.torque("turn", hand, {0, 0, 0.1}, Frame::body).against = body.parts()[0].get();
    CHECK(wakes_at_half(body));
  }
  SECTION("gravity") {
    MultiBody body;
    tower(body, 2);
    body.changing_gravity = TimeVector(late, 0., -9.81);
    CHECK(wakes_at_half(body));
  }
  SECTION("the end of a spring") {
    MultiBody body;
    tower(body, 2);
    body.spring("pull", point(*body.parts()[1], 0, 0), world(TimeVector(late, 0., 0.3)), 1e-3, 0, 0);
    CHECK(wakes_at_half(body));
  }
  SECTION("a joint that switches on") {
    MultiBody body;
    tower(body, 2);
    body.ball("hook", point(*body.parts()[1], 0, 0), world(0.11, 0, 0.3)).during(0.5);
    CHECK(wakes_at_half(body));
  }
  SECTION("a joint that switches off") {
    MultiBody body;
    body.plane("floor", Vec3<double>(0, 0, -5), {0, 0, 1});
    body.contact.sleep = Sleep{1e-3, 0.1};
    cube(body, "hung", {0, 0, 0});
    for (const double side : {-0.1, 0.1})
      body.ball("hook" + std::to_string(side > 0), point(*body.parts()[0], side > 0 ? 0 : kPi, 0),
                world(side, 0, 0))
          .during(0, 0.5);
    CHECK(wakes_at_half(body));
  }
  SECTION("a rest value") {
    MultiBody body;
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    body.contact.sleep = Sleep{1e-3, 0.1};
    Part& part = cube(body, "jack", {0, 0, 0.1});
    part.make_dynamic({"a3"});
    part.rest("a3", TimeFunction::formula("0.1 + 0.05 * min(max((t - 0.5) / 0.1, 0), 1)"));
    part.stiffness({{"a3", 1e5}});
    part.damping(0, 1e-2);
    body.gravity.setZero();
    CHECK(wakes_at_half(body));
  }
  SECTION("a floor that is removed") {
    MultiBody body;
    tower(body, 2);
    body.contact.planes.front().off = 0.5;
    Simulation simulation(body, "rk4");
    run_until_asleep(simulation);
    while (simulation.time() < 0.6) simulation.step(kStep);
    CHECK(none_sleeps(simulation));
    CHECK(simulation.state().v[2] == Approx(-9.81 * 0.1).epsilon(0.05));
  }
  SECTION("a velocity that the user sets") {
    MultiBody body;
    tower(body, 2);
    Simulation simulation(body, "rk4");
    run_until_asleep(simulation);
    State state = simulation.state();
    state.v[6] = 1;
    simulation.set_state(state);
    simulation.step(kStep);
    CHECK(none_sleeps(simulation));
  }
}

TEST_CASE("bodies on a moving plane do not sleep", "[sleep][contact]") {
  MultiBody body;
  tower(body, 2);
  body.contact.planes.front().point = TimeVector(0., 0., TimeFunction::formula("-0.2 * max(t - 0.5, 0) ^ 2"));
  Simulation simulation(body, "rk4");
  test::run(simulation, 1, 500);
  CHECK(none_sleeps(simulation));
  CHECK(simulation.state().q[2] == Approx(0.1 - 0.05).margin(1e-5));
}

TEST_CASE("connected bodies sleep together or not at all", "[sleep][contact]") {
  MultiBody body;
  tower(body, 2);
  cube(body, "apart", {3, 0, 0.1});
  Part& bob = test::add(body, "bob", "sphere", {}, 500);
  bob.rest({{"r", 0.05}}).place({1.5, 0, 0.65}, Eigen::Quaterniond::Identity());
  // A spring connects a pendulum to the upper cube.
  body.join("line", String{1}, {point(bob, 0, 0, 0), world(1, 0, 1.5)});
  body.spring("tie", point(bob, 0, 0, 0), point(*body.parts()[1], 0, 0, 0), 1e-2);
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.2, 100);
  CHECK(sleeps(simulation.state(), 2));
  CHECK_FALSE(sleeps(simulation.state(), 0));
  CHECK_FALSE(sleeps(simulation.state(), 1));
}

TEST_CASE("bodies connected by a torque sleep together or not at all", "[sleep][contact]") {
  MultiBody body;
  tower(body, 2);
  Part& top = test::add(body, "top", "sphere", {}, 500);
  top.rest({{"r", 0.1}}).place({3, 0, 5}, Eigen::Quaterniond::Identity());
  body.ball("hold", point(top, 0, 0, 0), world(3, 0, 5));
  body.torque("turn", top, {0, 0, 0.01}).against = body.parts()[0].get();
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.5, 250);
  CHECK(none_sleeps(simulation));
}

TEST_CASE("bodies sleep, and a joint that switches on within a step wakes them, also with error control",
          "[sleep][contact]") {
  for (const char* method : {"dormand_prince", "dop853", "esdirk"})
    for (const double tolerance : {0., 1e-6})
      for (const double on : {0.2, 0.207}) {
        CAPTURE(method, tolerance, on);
        MultiBody body;
        tower(body, 2);
        body.ball("hook", point(*body.parts()[1], 0, 0), world(0.11, 0, 0.3)).during(on);
        Simulation simulation(body, method, 1, tolerance);
        for (int i = 0; i < 11; ++i) simulation.step(1. / 60);
        CHECK(all_sleep(simulation));
        for (int i = 0; i < 4; ++i) simulation.step(1. / 60);
        CHECK(none_sleeps(simulation));
        for (int i = 0; i < 15; ++i) simulation.step(1. / 60);
        CHECK(all_sleep(simulation));
      }
}

TEST_CASE("constant forces, springs and dampers do no work on sleeping bodies", "[sleep][contact]") {
  for (const char* method : {"rk4", "implicit_midpoint", "linearly_implicit", "esdirk"}) {
    CAPTURE(method);
    MultiBody body;
    tower(body, 2);
    body.force("push", point(*body.parts()[1], 0, 0), {1, 0, 0});
    body.spring("tie", point(*body.parts()[0], 0, 0), world(0.5, 0, 0.2), 10, 2);
    Simulation simulation(body, method);
    run_until_asleep(simulation);
    const double balance = simulation.ledger().balance;
    const State asleep = simulation.state();
    for (int i = 0; i < 50; ++i) simulation.step(kStep);
    CHECK(simulation.state().q == asleep.q);
    CHECK(std::abs(simulation.ledger().balance - balance) < 1e-12);
  }
}

TEST_CASE("parts with local deformation sleep, on planes and obstacles", "[sleep][contact][long]") {
  for (const auto basis : {LocalSettings::Basis::nodes, LocalSettings::Basis::polynomial}) {
    const bool obstacle = basis == LocalSettings::Basis::nodes;
    CAPTURE(obstacle);
    MultiBody body;
    body.contact.sleep = Sleep{2e-3, 0.1};
    if (obstacle) {
      Eigen::Matrix3Xd x(3, 4);
      x << -2, 2, 2, -2, -2, -2, 2, 2, 0, 0, 0, 0;
      Eigen::Matrix3Xi triangles(3, 2);
      triangles << 0, 0, 1, 2, 2, 3;
      body.obstacle("floor", x, triangles);
    } else {
      body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    }
    auto& jelly = body.add<Primitive<Box>>("jelly", 1000.0);
    jelly.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.05}}).place({0, 0, 0.05});
    LocalSettings settings;
    settings.basis = basis;
    settings.resolution = 2;
    settings.alpha = 30;
    settings.energies = {local_law("elastic", {1e5, 0.3})};
    jelly.deform_locally(settings);
    // The ball falls for 0.8 s.
    Part& ball = test::add(body, "ball", "sphere", {}, 200);
    ball.rest({{"r", 0.03}}).place({0, 0, 0.13 + 0.5 * 9.81 * 0.64}, Eigen::Quaterniond::Identity());
    Simulation simulation(body, "linearly_implicit");
    while (simulation.time() < 0.78 && !sleeps(simulation.state(), 0)) simulation.step(kStep);
    REQUIRE(sleeps(simulation.state(), 0));
    const State asleep = simulation.state();
    const int n = simulation.model().parts()[0].n_q();
    while (simulation.time() < 0.79) simulation.step(kStep);
    CHECK(simulation.state().q.head(n) == asleep.q.head(n));
    while (simulation.time() < 0.9) simulation.step(kStep);
    CHECK(none_sleeps(simulation));
  }
}

TEST_CASE("sleep settings out of range are refused", "[sleep][failure]") {
  for (const Sleep& bad :
       {Sleep{0, 0.5}, Sleep{-1, 0.5}, Sleep{1e-3, -1}, Sleep{1e-3, 0}, Sleep{kInfinity, 0.5}}) {
    MultiBody body;
    tower(body, 1);
    body.contact.sleep = bad;
    CHECK_THROWS_WITH(Simulation(body, "rk4"),
                      test::has_text("expected a finite speed and a finite time above 0"));
  }
}

}  // namespace sleeping_test
