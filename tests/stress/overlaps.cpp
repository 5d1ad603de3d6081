// Parts that start inside other parts or inside a floor are separated at a bounded speed. The ledger records
// the energy that the separation adds.
// N54 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <pliant/body/joints/all_joints.h>
#include <pliant/part/local/local_laws.h>

#include "deepest.h"
#include "draws.h"
#include "motion.h"

namespace stress_overlaps_test {

using namespace pliant;
using test::Draws;

namespace {

constexpr double kSize = 0.1;  // the largest semi-axis, m
/// Overlapping parts are separated with this relative speed, in sizes (Part::size()) of the smaller part per
/// second.
constexpr double kSeparationSpeed = 1;

Part& add_part(MultiBody& body, const std::string& name, const std::string& shape) {
  Part& part = body.add(make_part(name, shape, {}, 1000));
  if (shape == "sphere")
    part.rest({{"r", kSize}});
  else if (shape == "capsule")
    part.rest({{"r", 0.07}, {"l", 0.03}});
  else
    part.rest({{"a1", kSize}, {"a2", 0.09}, {"a3", 0.08}});
  return part;
}
Eigen::Quaterniond random_rotation(Draws& draws) {
  return Eigen::Quaterniond(draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1),
                            draws.uniform(0.1, 1))
      .normalized();
}
/// Simulates until the time `until` (s). Returns the largest relative speed of the centres of any two of the
/// first `parts` parts, in sizes per second. Checks that the separation adds no velocity, and that no overlap
/// remains.
double separation_speed(Simulation& simulation, double until, int parts) {
  const double h = 1e-2, size = simulation.model().parts()[0].part->size();
  double fastest = 0;
  while (simulation.time() < until) {
    const VecX<double> before = simulation.state().q;
    simulation.step(h);
    const VecX<double> change = simulation.state().q - before;
    REQUIRE(change.allFinite());
    REQUIRE(simulation.ledger().kinetic == 0);
    for (int i = 0; i < parts; ++i)
      for (int j = 0; j < i; ++j)
        fastest =
            std::max(fastest, (change.segment<3>(7 * i) - change.segment<3>(7 * j)).norm() / (h * size));
  }
  CHECK(test::deepest_overlap(simulation) < 1e-9 * size);
  return fastest;
}
/// Adds a floor and a soft or rigid ellipsoid, whose depth in the floor is half of its vertical semi-axis.
Part& part_in_floor(MultiBody& body, bool soft) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  body.contact.friction = 0.3;
  auto& part = body.add<Primitive<Ellipsoid>>("part", 1000.0);
  part.rest({{"a1", kSize}, {"a2", 0.09}, {"a3", 0.08}}).place({0, 0, 0.04});
  if (!soft) return part;
  LocalSettings settings;
  settings.resolution = 2;
  settings.alpha = 2;
  settings.energies = {local_law("neo_hookean", {2e4, 0.3})};
  part.deform_locally(settings);
  return part;
}

/// Adds a ball with local deformation (a shell or a solid), or a rigid ball.
Part& ball(MultiBody& body, const std::string& name, const std::string& kind, const Vec3<double>& at) {
  auto& part = body.add<Primitive<Ellipsoid>>(name, kind == "shell" ? 1.0 : 1000.0);
  if (kind == "shell") part.make_shell();
  part.rest({{"a1", kSize}, {"a2", kSize}, {"a3", kSize}}).place(at);
  if (kind == "rigid") return part;
  LocalSettings settings;
  settings.resolution = 2;
  settings.alpha = 2;
  settings.energies = {kind == "shell" ? local_law("neo_hookean_membrane", {2e4, 0.4, 1e-3})
                                       : local_law("neo_hookean", {2e4, 0.3})};
  part.deform_locally(settings);
  return part;
}
/// Results of the separation of two parts of ball().
struct Separation {
  double first_overlap = 0;  // overlap at the start, m
  double fastest = 0;   // largest relative speed of the centres while the overlap is more than 0.2 kSize, in
                        // sizes a second
  double distance = 0;  // distance of the centres at the end, m
  double overlap = 0;   // overlap at the end, m
  double added = 0;     // change of the energy in the run, J
  Ledger ledger;
};
Separation separate_balls(Simulation& simulation, double until, double h) {
  const auto between = [&]() -> Vec3<double> {
    return simulation.model().position(simulation.state(), 1) -
           simulation.model().position(simulation.state(), 0);
  };
  Separation separation;
  const double start = simulation.ledger().energy();
  separation.first_overlap = test::deepest_overlap(simulation);
  while (simulation.time() < until) {
    const bool overlap = test::deepest_overlap(simulation) > 0.2 * kSize;
    const Vec3<double> before = between();
    simulation.step(h);
    if (overlap) separation.fastest = std::max(separation.fastest, (between() - before).norm() / (h * kSize));
  }
  separation.distance = between().norm();
  separation.overlap = test::deepest_overlap(simulation);
  separation.ledger = simulation.ledger();
  separation.added = separation.ledger.energy() - start;
  return separation;
}

}  // namespace

TEST_CASE("N54: separated parts push others out of their way within the step, along a whole row",
          "[contact]") {
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  body.plane("wall", Vec3<double>(-kSize, 0, 0), {1, 0, 0});
  constexpr double h = 1e-2, overlap = 0.5 * kSeparationSpeed * kSize * h, between = 0.05 * overlap;
  double at = 0;
  for (int i = 0; i < 8; ++i) {
    add_part(body, "ball" + std::to_string(i), "sphere").place({at, 0, 0});
    at += 2 * kSize + (i == 0 ? -overlap : between);
  }
  Simulation simulation(body, "rk4");
  simulation.step(h);
  CHECK(test::deepest_overlap(simulation) < 1e-10 * kSize);
  CHECK(simulation.ledger().kinetic == 0);
}

TEST_CASE("N54: deep overlaps are separated at one size per second, independently of motion elsewhere",
          "[contact]") {
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  add_part(body, "deep0", "sphere").place({0, 0, 0});
  add_part(body, "deep1", "sphere").place({kSize, 0, 0});
  add_part(body, "shallow0", "sphere").place({0, 5, 0});
  add_part(body, "shallow1", "sphere").place({2 * kSize - 5e-4, 5, 0});
  for (int i = 0; i < 6; ++i) add_part(body, "still" + std::to_string(i), "sphere").place({0, 10.0 + i, 0});
  add_part(body, "fast", "sphere").place({0.55, -5, 0}).velocity({100, 0, 0}, {0, 0, 0});
  body.plane("wall", Vec3<double>(1, 0, 0), {-1, 0, 0});
  constexpr double h = 1e-2;
  Simulation simulation(body, "rk4");
  const auto between = [&](int a, int b) {
    return (simulation.model().position(simulation.state(), a) -
            simulation.model().position(simulation.state(), b))
        .norm();
  };
  simulation.step(h);
  REQUIRE(std::abs(simulation.state().v[6 * 10]) < 50);  // the fast ball has hit the wall
  CHECK(between(0, 1) == Approx(kSize + kSeparationSpeed * kSize * h).epsilon(1e-9));
  CHECK(between(2, 3) == Approx(2 * kSize).epsilon(1e-12));
  simulation.step(h);
  CHECK(between(0, 1) == Approx(kSize + 2 * kSeparationSpeed * kSize * h).epsilon(1e-9));
}

TEST_CASE("N54: a ball whose centre is in a box leaves it through the nearest face", "[contact]") {
  for (const bool ball_first : {false, true}) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    auto add_ball = [&] { add_part(body, "ball", "sphere").place({0.05, -0.1, 0.26}); };
    if (ball_first) add_ball();
    body.add<Primitive<Box>>("box").rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.3}}).fix();
    if (!ball_first) add_ball();
    constexpr double h = 1e-2;
    Simulation simulation(body, "rk4");
    const int ball = ball_first ? 0 : 1;
    for (int i = 0; i < 500; ++i) {
      const Vec3<double> before = simulation.model().position(simulation.state(), ball);
      simulation.step(h);
      const Vec3<double> now = simulation.model().position(simulation.state(), ball);
      REQUIRE((now - before).norm() < kSeparationSpeed * kSize * h * (1 + 1e-9));
      REQUIRE((now - before).head<2>().norm() < 1e-15);
    }
    CHECK(simulation.model().position(simulation.state(), ball)[2] == Approx(0.3 + kSize).epsilon(1e-9));
    CHECK(simulation.ledger().kinetic == 0);
  }
}

TEST_CASE("N54: parts with local deformation are separated as wholes, from any depth", "[contact][long]") {
  // The final, small overlap is separated node by node, which dents the parts slightly. Only these dents need
  // work.
  struct Case {
    const char *one, *other, *method;
    double h, max_work;  // step, s; largest permitted work of contact, J
  };
  for (const auto& [one, other, method, h, max_work] :
       {Case{"shell", "shell", "semi_implicit_euler", 2e-3, 4e-4}, Case{"shell", "shell", "rk4", 2e-3, 4e-4},
        Case{"rigid", "shell", "semi_implicit_euler", 2e-3, 6e-4},
        Case{"solid", "solid", "semi_implicit_euler", 1e-3, 0.2},
        Case{"solid", "rigid", "semi_implicit_euler", 1e-3, 0.3},
        Case{"solid", "solid", "linearly_implicit", 5e-3, 0.2}})
    for (const double distance : {0.0, 0.1}) {
      MultiBody body;
      body.gravity.setZero();
      body.contact.active = true;
      const Vec3<double> along = Vec3<double>(1, 0.05, -0.3).normalized();
      ball(body, "one", one, Vec3<double>(0, 0, 0));
      ball(body, "other", other, distance * along);
      Simulation simulation(body, method);
      const Separation separation =
          separate_balls(simulation, (0.2 - distance) / (kSeparationSpeed * kSize) + 0.5, h);
      const double work = separation.ledger.work[static_cast<int>(Work::contact)];
      CAPTURE(one, other, method, distance, separation.added, work, separation.ledger.balance);
      CHECK(separation.first_overlap == Approx(2 * kSize - distance).margin(0.03 * kSize));
      CHECK(separation.fastest == Approx(kSeparationSpeed).epsilon(1e-6));
      CHECK(separation.distance > 1.9 * kSize);
      CHECK(separation.overlap < 1e-3 * kSize);
      CHECK(work > 0);
      CHECK(work < max_work);
      CHECK(separation.added < work);
      CHECK(std::abs(separation.ledger.balance) < 0.3 * work);
      CHECK(separation.ledger.momentum.norm() < 1e-12);
    }
}

TEST_CASE("N54: overlapping soft parts are separated also on a joint, on a floor and with global parameters",
          "[contact][long]") {
  MultiBody body;
  body.contact.active = true;
  SECTION("on a joint") {
    body.gravity.setZero();
    Part& one = ball(body, "one", "solid", Vec3<double>(0, 0, 0));
    ball(body, "other", "rigid", Vec3<double>(0, 0, -0.03));
    body.ball("hook", world(0, 0, kSize), point(one, kPi / 2, 0));
  }
  SECTION("with global parameters") {
    body.gravity.setZero();
    ball(body, "one", "shell", Vec3<double>(0, 0, 0)).stiffness({{"a3", 1e3}});
    ball(body, "other", "shell", Vec3<double>(0, 0, -0.03));
  }
  SECTION("on a floor") {
    body.plane("floor", Vec3<double>(0, 0, -kSize), {0, 0, 1});
    ball(body, "one", "solid", Vec3<double>(0, 0, 0));
    ball(body, "other", "solid", Vec3<double>(0.05, 0, 0));
  }
  Simulation simulation(body, "semi_implicit_euler");
  const Separation separation = separate_balls(simulation, 2, 1e-3);
  CAPTURE(separation.added, separation.ledger.work[static_cast<int>(Work::contact)],
          separation.ledger.balance);
  // On the floor the parts also move by gravity and impacts, so that no bound of their speed is specified.
  if (body.gravity.isZero()) CHECK(separation.fastest < 2.5 * kSeparationSpeed);
  CHECK(separation.distance > 1.8 * kSize);
  CHECK(separation.overlap < 1e-3 * kSize);
}

TEST_CASE("N54: overlapping round parts are separated at one size per second, from any depth", "[contact]") {
  Draws draws(41);
  for (const std::string shape : {"sphere", "ellipsoid"})
    for (const double distance : {0.14, 0.05, 1e-3, 1e-9, 0.0}) {
      MultiBody body;
      body.gravity.setZero();
      body.contact.active = true;
      const Vec3<double> along = draws.vector(1).normalized();
      for (const int i : {0, 1})
        add_part(body, "part" + std::to_string(i), shape).place(i * distance * along, random_rotation(draws));
      Simulation simulation(body, "rk4");
      CAPTURE(shape, distance);
      CHECK(separation_speed(simulation, 2.1, 2) < 1.01 * kSeparationSpeed);
    }
}

TEST_CASE("N54: several parts at one place are separated at a bounded speed", "[contact]") {
  Draws draws(42);
  for (const std::string shape : {"sphere", "ellipsoid"})
    for (const int n : {3, 4})
      for (const double spread : {0.0, 1e-9, 0.02}) {
        MultiBody body;
        body.gravity.setZero();
        body.contact.active = true;
        for (int i = 0; i < n; ++i)
          add_part(body, "part" + std::to_string(i), shape)
              .place(draws.vector(spread), random_rotation(draws));
        Simulation simulation(body, "rk4");
        CAPTURE(shape, n, spread);
        // Each part separates from each of the others; speeds of 2.3 and 2.5 have been observed.
        CHECK(separation_speed(simulation, 3.5, n) < n * kSeparationSpeed);
      }
}

TEST_CASE("N54: parts of other shapes with small overlaps are separated at a bounded speed", "[contact]") {
  Draws draws(43);
  // Parts with edges rotate during the separation, and contacts that oppose each other accelerate it: a speed
  // of 2.5 has been observed. For deep overlaps no bound of the speed is specified.
  struct Case {
    const char* shape;
    int trials;
    double max_speed;
  };
  for (const auto& [shape, trials, max_speed] :
       {Case{"superellipsoid", 1, 1.01}, Case{"capsule", 2, 1.01}, Case{"supertoroid", 1, 1.01},
        Case{"box", 3, 7}, Case{"cylinder", 3, 7}})
    for (int trial = 0; trial < trials; ++trial) {
      const Vec3<double> along = draws.vector(1).normalized();
      const Eigen::Quaterniond R[2]{random_rotation(draws), random_rotation(draws)};
      auto build = [&, shape = shape](MultiBody& body, double distance) {
        body.gravity.setZero();
        body.contact.active = true;
        for (const int i : {0, 1})
          add_part(body, "part" + std::to_string(i), shape).place(i * distance * along, R[i]);
      };
      double distance = 1, inside = 0;  // bounds of the distance at which the parts touch, m, for bisection
      for (int k = 0; k < 20; ++k) {
        const double middle = 0.5 * (distance + inside);
        MultiBody body;
        build(body, middle);
        const Model model(body);
        (ContactFinder(model).find(model.initial_state(), 0, 0).empty() ? distance : inside) = middle;
      }
      MultiBody body;
      build(body, 0.9 * distance);
      Simulation simulation(body, "rk4");
      CAPTURE(shape, trial);
      CHECK(separation_speed(simulation, 1, 2) < max_speed * kSeparationSpeed);
    }
}

TEST_CASE("N54: a rigid part is lifted out of the floor, and the ledger records the work", "[contact]") {
  for (const char* method : {"rk4", "semi_implicit_euler"})
    for (const double h : {4e-3, 1e-3}) {
      MultiBody body;
      const Part& part = part_in_floor(body, false);
      Simulation simulation(body, method);
      const double weight = 9.81 * part.total_mass();
      const double start = simulation.ledger().energy();
      const State first = simulation.state();
      test::run(simulation, h, 1);
      // The limit also allows for the fall in the step, with the velocity at the end of the step.
      CHECK(simulation.state().q[2] - first.q[2] <= h * kSeparationSpeed * kSize + 2.01 * 9.81 * h * h);
      test::run(simulation, 0.4 - h, static_cast<int>(std::lround(0.4 / h)) - 1);
      const Ledger ledger = simulation.ledger();
      CAPTURE(method, h);
      CHECK(simulation.state().q[2] == Approx(0.08).margin(1e-12));
      CHECK(ledger.work[static_cast<int>(Work::contact)] == Approx(weight * 0.04).epsilon(1e-11));
      CHECK(ledger.energy() - start == Approx(weight * 0.04).epsilon(1e-11));
      CHECK(std::abs(ledger.balance) < 1e-12);
    }
}

TEST_CASE("N54: the energy that a separation adds to deformable parts is recorded to the error of a step",
          "[contact]") {
  auto check = [](const char* method, auto&& build, double min_work, double order, double max_balance) {
    std::vector<double> balance;
    for (const int steps : {300, 600, 1200}) {
      MultiBody body;
      build(body);
      Simulation simulation(body, method);
      test::run(simulation, 0.3, steps);
      const Ledger ledger = simulation.ledger();
      CHECK(ledger.work[static_cast<int>(Work::contact)] > min_work);
      balance.push_back(std::abs(ledger.balance));
    }
    CAPTURE(balance[0], balance[1], balance[2]);
    CHECK(test::observed_order(balance) > order);
    CHECK(balance.back() < max_balance);
  };
  SECTION("global parameters") {
    auto build = [](MultiBody& body) {
      body.gravity.setZero();
      body.contact.active = true;
      for (const int i : {0, 1})
        add_part(body, "part" + std::to_string(i), "ellipsoid")
            .place({0, 0, 0.11 * i})
            .stiffness({{"a1", 3e4}, {"a2", 3e4}, {"a3", 3e4}});
    };
    check("rk4", build, 0.015, 1.8, 4e-5);  // the work is 0.017 J
  }
  SECTION("nodes") {
    check(
        "semi_implicit_euler", [](MultiBody& body) { part_in_floor(body, true); }, 0.5, 1, 1.3e-2);
  }
}

}  // namespace stress_overlaps_test
