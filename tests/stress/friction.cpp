// The work of friction in the ledger, for sliding blocks, a ball that starts to roll and a conveyor belt.
// Without sliding the ledger records no work of friction.
#include "catch.h"

#include <cmath>
#include <string>
#include <vector>

#include "motion.h"

namespace stress_friction_test {

using namespace pliant;

namespace {

constexpr double kG = 9.81, kMu = 0.4;  // m/s^2; coefficient of friction

constexpr double kTilt = 0.6;  // inclination of the slope, rad

double work(Simulation& simulation, Work kind) {
  return simulation.ledger().work[static_cast<int>(kind)];
}
Part& box(MultiBody& body, const std::string& name, const Vec3<double>& half, const Vec3<double>& at,
          const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity()) {
  return body.add(make_part(name, "box", {}, 1000))
      .rest({{"a1", half[0]}, {"a2", half[1]}, {"a3", half[2]}})
      .place(at, R);
}
void floor(MultiBody& body) {
  body.contact.friction = kMu;
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
/// Adds a block on a slope that descends along x.
Part& block_on_slope(MultiBody& body, double friction) {
  body.contact.friction = friction;
  const Eigen::Quaterniond R(Eigen::AngleAxisd(kTilt, Vec3<double>::UnitY()));
  const Vec3<double> n = R * Vec3<double>::UnitZ();
  body.plane("slope", Vec3<double>(0, 0, 0), n);
  return box(body, "block", {0.1, 0.1, 0.1}, 0.1 * n, R);
}
/// Checks that friction has dissipated this energy (J), that contact has done no work, and that the ledger
/// balances.
void check_friction(Simulation& simulation, double dissipated) {
  CHECK(work(simulation, Work::friction) == Approx(-dissipated).epsilon(1e-12).margin(1e-13));
  CHECK(std::abs(work(simulation, Work::contact)) < 1e-11);
  CHECK(std::abs(simulation.ledger().balance) < 1e-12);
}

}  // namespace

TEST_CASE("friction dissipates mu m g times the distance that a block slides", "[contact]") {
  for (const std::string method : {"rk4", "linearly_implicit", "semi_implicit_euler"}) {
    CAPTURE(method);
    std::vector<double> errors;
    for (const double h : {4e-3, 2e-3, 1e-3}) {
      MultiBody body;
      floor(body);
      Part& block = box(body, "block", {0.3, 0.2, 0.1}, {0, 0, 0.1}).velocity({2, 0.5, 0}, {0, 0, 0});
      Simulation simulation(body, method);
      test::run(simulation, 0.3, static_cast<int>(std::lround(0.3 / h)));
      const double dissipated = kMu * block.total_mass() * kG * simulation.state().q.head<2>().norm();
      if (method != "semi_implicit_euler") check_friction(simulation, dissipated);
      errors.push_back(std::abs(work(simulation, Work::friction) / dissipated + 1));
      // After the stop, the dissipated energy is the initial kinetic energy.
      test::run(simulation, 0.5, static_cast<int>(std::lround(0.5 / h)));
      CHECK(simulation.state().v.norm() < 1e-12);
      check_friction(simulation, 0.5 * block.total_mass() * (2 * 2 + 0.5 * 0.5));
    }
    if (method != "semi_implicit_euler") continue;
    // The distance has an error of first order, like the method.
    CHECK(test::observed_order(errors) == Approx(1).margin(0.02));
    CHECK(errors.back() < 4e-3);
  }
}

TEST_CASE("friction on a slope dissipates energy of a sliding block, and none of a sticking block",
          "[contact]") {
  for (const double friction : {kMu, 1.0}) {
    MultiBody body;
    Part& block = block_on_slope(body, friction);
    Simulation simulation(body, "rk4");
    const Vec3<double> start = simulation.state().q.head<3>();
    test::run(simulation, 0.5, 250);
    const double distance = (simulation.state().q.head<3>() - start).norm();
    CHECK((distance > 0.2) == (friction == kMu));
    CAPTURE(friction);
    check_friction(simulation,
                   friction == kMu ? kMu * block.total_mass() * kG * std::cos(kTilt) * distance : 0);
  }
}

TEST_CASE("a ball that starts to roll dissipates a seventh of m v^2, and no further energy", "[contact]") {
  MultiBody body;
  floor(body);
  Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
  ball.rest({{"r", 0.1}}).place({0, 0, 0.1}).velocity({1, 0, 0}, {0, 0, 0});
  Simulation simulation(body, "rk4");
  for (const double until : {0.4, 0.8}) {
    test::run(simulation, until - simulation.time(), 200);
    check_friction(simulation, ball.total_mass() / 7);
  }
}

TEST_CASE("friction between parts dissipates the energy of their relative motion", "[contact]") {
  SECTION("both parts are free") {
    MultiBody body;
    floor(body);
    body.contact.pairs = {{"lower", "floor", true, 0.0, {}}};
    Part& lower = box(body, "lower", {1, 0.3, 0.05}, {0, 0, 0.05});
    Part& upper = box(body, "upper", {0.1, 0.1, 0.1}, {-0.5, 0, 0.2}).velocity({1.5, 0, 0}, {0, 0, 0});
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.6, 300);
    const double m = upper.total_mass(), M = lower.total_mass();
    CHECK(simulation.state().v[0] == Approx(1.5 * m / (m + M)).epsilon(1e-12));
    CHECK(simulation.state().v[6] == Approx(1.5 * m / (m + M)).epsilon(1e-12));
    check_friction(simulation, 0.5 * m * M / (m + M) * 1.5 * 1.5);
  }
  SECTION("a belt accelerates a load: half of the work of the belt is kinetic energy of the load") {
    MultiBody body;
    body.contact.active = true;
    body.contact.friction = kMu;
    PrescribedMotion motion;
    motion.position = TimeVector(TimeFunction::formula("t"), 0, -0.05);
    body.add(make_part("belt", "box", {}, 1000)).rest({{"a1", 3}, {"a2", 1}, {"a3", 0.05}}).prescribe(motion);
    Part& load = box(body, "load", {0.1, 0.1, 0.1}, {0, 0, 0.1});
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.5, 250);
    CHECK(simulation.state().v[0] == Approx(1).epsilon(1e-12));
    CHECK(work(simulation, Work::friction) == Approx(-0.5 * load.total_mass()).epsilon(1e-12));
    CHECK(work(simulation, Work::contact) == Approx(load.total_mass()).epsilon(1e-12));
    CHECK(std::abs(simulation.ledger().balance) < 1e-12);
  }
}

TEST_CASE("forces and torques that press a part onto a floor do no work, and the ledger records none",
          "[contact]") {
  for (const char* method :
       {"rk4", "semi_implicit_euler", "linearly_implicit", "implicit_midpoint", "dop853"})
    for (const bool moving : {false, true}) {
      CAPTURE(method, moving);
      MultiBody body;
      floor(body);
      Part& block = box(body, "block", {0.1, 0.12, 0.1}, {0, 0, 0.1});
      if (moving) block.velocity({0.8, 0, 0}, {0, 0, 0});
      body.force("pressed", point(block, 0, 0, 0), Vec3<double>(0, 0, -94.2));
      body.torque("turned", block, Vec3<double>(0.3, 0.2, 0));
      Simulation simulation(body, method);
      test::run(simulation, 0.3, 300);
      // Works of about 94 N times 1e-10 m have been observed; 1e-10 m is within the tolerance of resting
      // contacts. Friction dissipates 3 J if the block moves.
      CHECK(std::abs(work(simulation, Work::forces)) < 1e-7);
      CHECK(std::abs(work(simulation, Work::contact)) < 1e-7);
      CHECK(std::abs(simulation.ledger().balance) < 1e-9);
    }
}

TEST_CASE("a force that pulls a block over a floor does work along the displacement of the block",
          "[contact]") {
  MultiBody body;
  floor(body);
  Part& block = box(body, "block", {0.3, 0.2, 0.1}, {0, 0, 0.1});
  block.prepare();
  const double pull = 1.5 * kMu * block.total_mass() * kG;
  body.force("pull", point(block, 0, 0, 0), Vec3<double>(pull, 0, -30));
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.3, 150);
  const double distance = simulation.state().q[0];
  CHECK(distance > 0.05);
  CHECK(work(simulation, Work::forces) == Approx(pull * distance).epsilon(1e-11));
  CHECK(work(simulation, Work::friction) ==
        Approx(-kMu * (block.total_mass() * kG + 30) * distance).epsilon(1e-11));
  CHECK(std::abs(simulation.ledger().balance) < 1e-11);
}

}  // namespace stress_friction_test
