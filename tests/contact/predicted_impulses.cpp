// Fixed steps with resting contacts, whose impulses are predicted. Bodies that roll have errors of second
// order. If a contact force ends or jumps, its predicted impulse leaves no velocity error.
#include "catch.h"

#include <cmath>
#include <string>
#include <vector>

#include <pliant/simulate/simulation.h>

#include "motion.h"

namespace predicted_impulses_test {

using namespace pliant;

namespace {

constexpr double kGravity = 9.81;  // m/s^2

void floor_with_friction(MultiBody& body, double friction) {
  body.contact.active = true;
  body.contact.friction = friction;
  body.contact.planes.emplace_back().name = "floor";
}

/// Adds an egg that lies tilted on a rough floor; it rocks and rolls.
void tilted_egg(MultiBody& body, bool dynamic = false) {
  floor_with_friction(body, 2);
  Part& egg = body.add<Primitive<Superellipsoid>>("egg", 1000.0);
  egg.rest({{"a1", 0.08}, {"a2", 0.09}, {"a3", 0.12}, {"eps1", 1}, {"eps2", 1}});
  if (dynamic) egg.stiffness({{"a3", 3e3}}).damping(0, 1e-3);
  const double tilt = 0.5;
  const Vec3<double> down(0, -std::sin(tilt),
                          std::cos(tilt));  // the normal of the floor, in the axes of the egg
  const double height = std::hypot(0.09 * down[1], 0.12 * down[2]);
  egg.place({0, 0, height}, Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Vec3<double>::UnitX())));
}

/// The coordinates at the end of a run, and the error of the energy balance, J.
struct Result {
  VecX<double> q;
  double balance;
};
/// Runs a scene for `end` seconds with steps of h seconds. If h is 0, the steps are those of dop853 with a
/// tolerance of 1e-9.
template <class Build>
Result run(Build&& build, const std::string& method, double h, double end) {
  MultiBody body;
  build(body);
  Simulation simulation(body, h == 0 ? "dop853" : method, 1, h == 0 ? 1e-9 : 0);
  if (h == 0) {
    while (simulation.time() < end) simulation.step_up_to(end);
  } else {
    for (int i = 0; i < std::lround(end / h); ++i) simulation.step(h);
  }
  const Ledger ledger = simulation.ledger();
  return {simulation.state().q, std::abs(ledger.balance)};
}

}  // namespace

TEST_CASE("a rolling egg has errors of second order with fixed steps", "[contact][long]") {
  const double end = 1;
  const bool dynamic = GENERATE(false, true);
  const auto build = [&](MultiBody& body) { tilted_egg(body, dynamic); };
  const Result exact = run(build, "dop853", 0, end);
  for (const std::string method : {"rk4", "implicit_midpoint", "dop853"}) {
    std::vector<double> errors, balances;
    for (const double h : {0.005, 0.0025, 0.00125}) {
      const Result result = run(build, method, h, end);
      errors.push_back((result.q - exact.q).norm());
      balances.push_back(result.balance);
    }
    CAPTURE(dynamic, method, errors, balances);
    CHECK(test::observed_order(errors) > 1.8);
    CHECK(errors.back() < 2e-4);
    CHECK(balances.back() < 1e-5);
  }
}

TEST_CASE("a ball rolls down a slope exactly, with fixed steps of any length", "[contact]") {
  const double angle = 0.3, r = 0.1, end = 1;
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(angle, Vec3<double>::UnitY()));
  const Vec3<double> n = tilt * Vec3<double>::UnitZ(), down = tilt * Vec3<double>::UnitX();
  for (const double h : {0.02, 0.005}) {
    CAPTURE(h);
    MultiBody body;
    body.contact.friction = 1;
    body.plane("slope", Vec3<double>(0, 0, 0), n);
    body.add<Primitive<Sphere>>("ball").rest({{"r", r}}).place(r * n);
    Simulation simulation(body, "rk4");
    for (int i = 0; i < std::lround(end / h); ++i) simulation.step(h);
    const double a = 5.0 / 7 * kGravity * std::sin(angle);
    const Vec3<double> c = simulation.state().q.head<3>();
    CHECK(c.dot(down) == Approx(a / 2 * end * end).epsilon(1e-9));
    CHECK(std::abs(c.dot(n) - r) < 1e-9);
    CHECK(simulation.state().contact_cache[0].lasting);
  }
}

TEST_CASE("a force of contact that ceases leaves no velocity behind", "[contact]") {
  // Gravity reverses, or the floor is removed, at the end of a step or in the middle of a step.
  const double h = 0.01;
  for (const double turn : {0.1, 0.105})
    for (const bool ends : {false, true}) {
      CAPTURE(turn, ends);
      MultiBody body;
      floor_with_friction(body, 0.5);
      body.add<Primitive<Sphere>>("ball").rest({{"r", 0.1}}).place({0, 0, 0.1});
      if (ends)
        body.contact.planes[0].off = turn;
      else
        body.changing_gravity = TimeVector(
            0, 0, TimeFunction::formula("9.81 * (2 * step(t - " + std::to_string(turn) + ") - 1)"));
      Simulation simulation(body, "rk4");
      for (int i = 0; i < 20; ++i) simulation.step(h);
      const double t = 0.2 - turn, sign = ends ? -1 : 1;
      const double jump =
          turn == 0.1 ? 1e-9 : 0.51 * h * kGravity;  // within a step the error is of first order
      CHECK(std::abs(simulation.state().v[2] - sign * kGravity * t) <= jump);
      CHECK(std::abs(simulation.state().q[2] - 0.1 - sign * kGravity * t * t / 2) <= 0.1 * jump);
    }
}

TEST_CASE("impulses are predicted for bodies that roll, and not for bodies at rest", "[contact]") {
  MultiBody body;
  floor_with_friction(body, 0.5);
  body.add<Primitive<Sphere>>("still").rest({{"r", 0.1}}).place({0, 0, 0.1});
  body.add<Primitive<Sphere>>("rolling")
      .rest({{"r", 0.1}})
      .place({1, 0, 0.1})
      .velocity({1, 0, 0}, {0, 10, 0});
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 5; ++i) simulation.step(0.01);
  const std::vector<Contact>& contacts = simulation.contact()->contacts();
  REQUIRE(contacts.size() == 2);
  CHECK(contacts[0].predicted.isZero(0));
  CHECK(contacts[1].predicted.z() == Approx(0.005 * kGravity * body.parts()[1]->total_mass()));
}

TEST_CASE("an impact on a resting ball and the reaction of the floor are not predicted", "[contact]") {
  MultiBody body;
  floor_with_friction(body, 0.5);
  const char* names[] = {"lower", "upper"};
  for (const int i : {0, 1})
    body.add<Primitive<Sphere>>(names[i]).rest({{"r", 0.1}}).place({0, 0, 0.1 + 0.2 * i + 0.3 * i});
  // With nine more balls, more than eight parts can move, and the times of impacts are not located.
  for (int i = 0; i < 9; ++i)
    body.add<Primitive<Sphere>>("other" + std::to_string(i)).rest({{"r", 0.1}}).place({1.0 + i, 0, 0.1});
  Simulation simulation(body, "rk4");
  double highest = 0;
  bool met = false;
  for (int i = 0; i < 100; ++i) {
    simulation.step(0.01);
    highest = std::max(highest, simulation.state().q[2]);
    for (const CachedContact& cached : simulation.state().contact_cache)
      if (cached.between[0] <= 1 && cached.force.norm() > 500) {
        met = true;
        CHECK_FALSE(cached.lasting);
      }
  }
  CHECK(met);
  CHECK(highest < 0.1 + 1e-9);
  CHECK(std::abs(simulation.state().q[9] - 0.3) < 1e-6);
}

TEST_CASE("a ball that rolls on a mesh rebounds from a wall of the same mesh", "[contact]") {
  MultiBody body;
  body.contact.friction = 0;
  body.contact.restitution = 0.8;
  body.add<Primitive<Sphere>>("ball").rest({{"r", 0.1}}).place({0, 0, 0.1}).velocity({1, 0, 0}, {0, 0, 0});
  Eigen::Matrix3Xd x(3, 6);
  x.col(0) << -1, -1, 0;
  x.col(1) << 0.5, -1, 0;
  x.col(2) << 0.5, 1, 0;
  x.col(3) << -1, 1, 0;
  x.col(4) << 0.5, -1, 1;
  x.col(5) << 0.5, 1, 1;
  Eigen::Matrix3Xi triangles(3, 4);
  triangles.col(0) << 0, 1, 2;
  triangles.col(1) << 0, 2, 3;
  triangles.col(2) << 1, 4, 5;
  triangles.col(3) << 1, 5, 2;
  body.obstacle("room", x, triangles);
  Simulation simulation(body, "rk4");
  bool lasted = false;
  for (int i = 0; i < 100; ++i) {
    simulation.step(5e-3);
    for (const CachedContact& cached : simulation.state().contact_cache) lasted = lasted || cached.lasting;
  }
  CHECK(lasted);
  CHECK(simulation.state().v[0] == Approx(-0.8).margin(1e-9));
  CHECK(simulation.state().q[0] == Approx(0.4 - 0.8 * 0.1).margin(0.01));
  CHECK(simulation.state().q[2] == Approx(0.1).margin(1e-6));
}

TEST_CASE("the ledger is balanced when bodies with predicted impulses lose contact", "[contact]") {
  for (const bool damped : {false, true}) {
    MultiBody body;
    floor_with_friction(body, 0.8);
    body.contact.planes[0].off = 0.253;
    for (int i = 0; i < 9; ++i) {  // with more than eight moving parts, the times of impacts are not located
      Part& ball = body.add<Primitive<Ellipsoid>>("ball" + std::to_string(i), 1000.0);
      ball.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place({0.5 * i, 0, 0.1});
      ball.velocity({0.2, 1, 0}, {-10, 2, 0});
      if (damped) ball.damping(0, 0, 0.5);
    }
    Simulation simulation(body, "rk4");
    for (int i = 0; i < 40; ++i) simulation.step(0.01);
    CAPTURE(damped);
    CHECK(simulation.state().q[2] < 0.02);
    // The step in which the floor is removed is divided at this time; no step is repeated.
    CHECK(simulation.step_counters().evaluations == 4 * 41);
    // The energy is 45 J for each ball.
    CHECK(std::abs(simulation.ledger().balance) < (damped ? 1e-3 : 1e-9));
  }
}

TEST_CASE("a rolling body resumes from its state with the same bits", "[contact]") {
  MultiBody body;
  tilted_egg(body);
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 20; ++i) simulation.step(0.01);
  REQUIRE(simulation.state().contact_cache.size() == 1);
  REQUIRE(simulation.state().contact_cache[0].lasting);
  State other = simulation.state();
  other.contact_cache[0].lasting = false;
  CHECK(hash(other) != hash(simulation.state()));
  Simulation resumed(body, "rk4");
  resumed.set_state(simulation.state());
  for (Simulation* each : {&simulation, &resumed})
    for (int i = 0; i < 20; ++i) each->step(0.01);
  CHECK(hash(resumed.state()) == hash(simulation.state()));
}

TEST_CASE("eggs on a joint roll with errors of second order, and the joint stays closed", "[contact][long]") {
  const double end = 0.4;
  const auto build = [](MultiBody& body) {
    floor_with_friction(body, 2);
    body.contact.between_parts = false;
    for (const int i : {0, 1}) {
      Part& egg = body.add<Primitive<Superellipsoid>>("egg" + std::to_string(i), 1000.0);
      egg.rest({{"a1", 0.08}, {"a2", 0.09}, {"a3", 0.12}, {"eps1", 1}, {"eps2", 1}});
      const double tilt = 0.5, height = std::hypot(0.09 * std::sin(tilt), 0.12 * std::cos(tilt));
      egg.place({0.16 * i, 0, height}, Eigen::Quaterniond(Eigen::AngleAxisd(tilt, Vec3<double>::UnitX())));
    }
    body.ball("link", point(*body.parts()[0], 0, 0), point(*body.parts()[1], 0, M_PI));
  };
  const Result exact = run(build, "dop853", 0, end);
  std::vector<double> errors;
  for (const double h : {0.004, 0.002, 0.001})
    errors.push_back((run(build, "rk4", h, end).q - exact.q).norm());
  CAPTURE(errors);
  CHECK(test::observed_order(errors) > 1.8);
  CHECK(errors.back() < 1e-4);
}

}  // namespace predicted_impulses_test
