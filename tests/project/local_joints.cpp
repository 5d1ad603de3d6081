// Joints, springs, limits, failures and assembly of parts with local deformation.
#include "catch.h"

#include <pliant/body/joints/all_joints.h>
#include <pliant/body/material_frame.h>
#include <pliant/part/local/local_laws.h>

#include "motion.h"
#include "spring_net.h"
#include "widest_gap.h"

namespace local_joints_test {

using namespace pliant;
using test::widest_gap;

namespace {

/// Adds an ellipsoidal shell with a net of springs. soft: whether its semi-axes are dynamic.
Part& balloon(MultiBody& body, const std::string& name, const Vec3<double>& at, bool soft) {
  auto& part = body.add<Primitive<Ellipsoid>>(name, 2.0);
  part.make_shell().rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}}).place(at);
  if (soft) part.stiffness({{"a1", 500}, {"a2", 500}, {"a3", 400}});
  LocalSettings settings = test::net(3, 60);
  settings.velocity = test::sample_velocity;
  part.deform_locally(settings);
  return part;
}

}  // namespace

TEST_CASE("soft shells that hang from each other: joints stay closed, and the order is kept",
          "[local][joints][long]") {
  for (const bool soft : {false, true}) {
    std::vector<double> energy;
    for (const int steps : {100, 200, 400}) {
      MultiBody body;
      Part& upper = balloon(body, "upper", {0, 0, -0.6}, soft);
      Part& lower = balloon(body, "lower", {0.5, 0, -1.2}, soft);
      body.ball("top", world(0, 0, 0), point(upper, kPi / 2, 0));
      body.ball("between", point(upper, 0, 0), point(lower, kPi / 2, 0));
      Simulation simulation(body, "rk4");
      const double start = simulation.ledger().energy();
      for (int i = 0; i < steps; ++i) {
        simulation.step(1.0 / steps);
        REQUIRE(widest_gap(simulation) <= 1e-11);
      }
      energy.push_back(std::abs(simulation.ledger().energy() - start));
    }
    CAPTURE(soft, energy[0], energy[1], energy[2]);
    CHECK(test::observed_order(energy) >= 3.8);
    CHECK(energy.back() <= 1e-4);
  }
}

TEST_CASE("soft shells on joints: the augmented matrix and the block solver agree", "[local][joints]") {
  std::vector<VecX<double>> accelerations;
  for (const auto solver : {JointSolver::Choice::blocks, JointSolver::Choice::augmented}) {
    MultiBody body;
    body.joint_solver.choice = solver;
    Part& upper = balloon(body, "upper", {0, 0, -0.6}, true);
    Part& lower = balloon(body, "lower", {0.5, 0, -1.2}, true);
    body.ball("top", world(0, 0, 0), point(upper, kPi / 2, 0));
    body.hinge("between", point(upper, 0, 0), point(lower, kPi / 2, 0), {0, 1, 0});
    Simulation simulation(body, "rk4");
    CHECK(simulation.model().islands()[0].augmented == (solver == JointSolver::Choice::augmented));
    Workspace<double> work;
    const State& state = simulation.state();
    simulation.dynamics().accelerations(0, state.q, state.v, state, work);
    accelerations.push_back(work.v_dot);
  }
  CHECK((accelerations[0] - accelerations[1]).norm() <= 1e-9 * accelerations[0].norm());
}

TEST_CASE("a parameter of a soft shell reaches its limit: P and L are conserved, and no energy is added",
          "[local][limits][long]") {
  MultiBody body;
  body.gravity.setZero();
  Part& part = balloon(body, "ball", {0, 0, 0}, true);
  part.limits("a1", {0.45, 0.52}).initial_rate({{"a1", 0.5}}).velocity({0.1, 0, 0}, {0.2, 0.1, 0.3});
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    Simulation simulation(body, method);
    const Ledger start = simulation.ledger();
    double energy = start.energy();
    for (int i = 0; i < 2000; ++i) {
      simulation.step(5e-4);
      REQUIRE(simulation.state().q[7] <= 0.52);
    }
    const Ledger end = simulation.ledger();
    CHECK(simulation.step_counters().limit_impulses > 0);
    CHECK(end.energy() < energy);
    // Semi-implicit Euler conserves P and L of rotating parts to its order only.
    const double rounding = std::string(method) == "rk4" ? 1e-8 : 2e-3;
    CHECK((end.momentum - start.momentum).norm() <= rounding * start.momentum.norm());
    CHECK((end.angular_momentum - start.angular_momentum).norm() <= rounding * start.angular_momentum.norm());
  }
}

TEST_CASE("a soft shell on a string: the string goes taut, and the gap stays closed", "[local][joints]") {
  MultiBody body;
  Part& part = balloon(body, "ball", {0.4, 0, -0.4}, false);
  body.join("cord", String{0.6}, {world(0, 0, 0), point(part, kPi / 2, 0)});
  Simulation simulation(body, "rk4");
  bool taut = false;
  for (int i = 0; i < 1500; ++i) {
    simulation.step(1e-3);
    REQUIRE(widest_gap(simulation) <= 1e-9);
    taut = taut || simulation.state().joints[0] == JointMode::closed;
  }
  CHECK(taut);
}

TEST_CASE("the ledger of a soft shell: damping, drag, a damped spring and a moving anchor of its joint",
          "[local][joints][long]") {
  std::vector<double> balance;
  for (const int steps : {100, 200, 400}) {
    MultiBody body;
    auto& part = body.add<Primitive<Ellipsoid>>("ball", 2.0);
    part.make_shell()
        .rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}})
        .place({0, 0, -0.6})
        .damping(0.3, 1e-3, 0.2);
    part.stiffness({{"a1", 500}, {"a2", 500}, {"a3", 400}});
    LocalSettings settings = test::net(3, 60);
    settings.velocity = test::sample_velocity;
    settings.alpha = 0.4;
    settings.beta = 2e-3;
    part.deform_locally(settings);
    const TimeVector hand(test::wave(0, 0.1, 3), test::wave(0, 0.05, 4), TimeFunction(0.0));
    body.ball("hand", world(hand), point(part, kPi / 2, 0));
    body.spring("spring", world(1, 0, -1), point(part, 0.3, 0.4), 30, 0.5);
    Simulation simulation(body, "rk4");
    for (int i = 0; i < steps; ++i) simulation.step(1.0 / steps);
    const Ledger end = simulation.ledger();
    balance.push_back(std::abs(end.balance));
    for (const Work work : {Work::damping, Work::drag, Work::spring_damping}) {
      CAPTURE(static_cast<int>(work));
      CHECK(end.work[static_cast<int>(work)] < 0);
    }
    CHECK(std::abs(end.work[static_cast<int>(Work::anchors)]) > 0.01);
  }
  CAPTURE(balance[0], balance[1], balance[2]);
  CHECK(test::observed_order(balance) >= 3.7);
  CHECK(balance.back() <= 1e-4);
}

TEST_CASE("a soft shell with a step that is too long: the message names the part and the step", "[local]") {
  MultiBody body;
  balloon(body, "ball", {0, 0, 0}, false);
  Simulation simulation(body, "rk4");
  const double h = 20 * largest_stable_step(simulation);
  std::string what;
  try {
    for (int i = 0; i < 1000; ++i) simulation.step(h);
  } catch (const NumericalFailure& failure) {
    what = failure.what();
  }
  CHECK_THAT(what, test::has_text("in a step of"));
  CHECK_THAT(what, test::has_text("'ball'") || test::has_text("ball."));
}

TEST_CASE("a rubber balloon with a pressure that no stretch can balance is reported as burst", "[local]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Sphere>>("balloon", 1);
  part.rest({{"r", 0.1}}).make_shell();
  LocalSettings settings;
  settings.resolution = 2;
  settings.energies = {local_law("neo_hookean_membrane", {2e5, 0.5, 5e-4}), local_law("pressure", {5000})};
  part.deform_locally(settings);
  Simulation simulation(body, "rk4");
  const double h = 0.5 * largest_stable_step(simulation);
  std::string what;
  try {
    for (int i = 0; i < 100000; ++i) simulation.step(h);
  } catch (const NumericalFailure& failure) {
    what = failure.what();
  }
  CHECK_THAT(what, test::has_text("part 'balloon' has burst"));
  CHECK_THAT(what, test::has_text("does not balance"));
}

TEST_CASE("an element that is inverted at time 0 stops the run with the name of its part", "[local]") {
  MultiBody body;
  auto& part = body.add<Primitive<Sphere>>("jelly", 1000);
  LocalSettings settings;
  settings.resolution = 2;
  settings.energies = {local_law("corotated", {1e4, 0.3})};
  settings.displacement = [](const Vec3<double>& X) -> Vec3<double> {
    return X[2] > 0.9 ? Vec3<double>(0, 0, -0.95) : Vec3<double>(0, 0, 0);
  };
  part.deform_locally(settings);
  CHECK_THROWS_AS(Simulation(body), NumericalFailure);
  CHECK_THROWS_WITH(Simulation(body), test::has_text("part 'jelly'"));
}

TEST_CASE("the points of a hinge on a shell move with its surface", "[local][joints]") {
  MultiBody body;
  Part& part = balloon(body, "balloon", {0, 0, 0}, false);
  for (const double w : {0.4, 1.0})
    for (const Point& at : framed(point(part, 0.3, 0.2, w), Mat3<double>::Identity()).points)
      CHECK((at.material.w == 1 || at.material.w == w));
  Simulation simulation(body);
  const FramedPoint frame = framed(point(part, 0.3, 0.2), Mat3<double>::Identity());
  for (const Point& at : frame.points) CHECK(!part.local()->weights(part, at.material).node.empty());
}

TEST_CASE("assembly before time 0 by both solvers, with and without soft shells", "[local][assembly]") {
  for (const bool local : {false, true}) {
    std::vector<VecX<double>> places;
    for (const auto solver : {JointSolver::Choice::blocks, JointSolver::Choice::augmented}) {
      MultiBody body;
      body.joint_solver.choice = solver;
      body.stabilization.assemble_first = true;
      std::vector<Part*> parts;
      for (int i = 0; i < 3; ++i) {
        auto& part = body.add<Primitive<Ellipsoid>>("part" + std::to_string(i), 2.0);
        part.make_shell().rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}}).stiffness({{"a1", 500}, {"a3", 400}});
        part.place({0.3 * i, 1.0 * i, 0.5 * i});
        if (local) part.deform_locally(test::net(2, 60));
        parts.push_back(&part);
      }
      body.ball("foot", world(0, 0, 0), point(*parts[0], -kPi / 2, 0));
      body.ball("one", point(*parts[0], kPi / 2, 0), point(*parts[1], -kPi / 2, 0));
      body.ball("two", point(*parts[1], kPi / 2, 0), point(*parts[2], -kPi / 2, 0));
      body.ball("head", world(0.5, 0.5, 3.9), point(*parts[2], kPi / 2, 0));
      const Simulation simulation(body, "rk4");
      CHECK(widest_gap(simulation) <= 1e-9);
      places.push_back(simulation.state().q);
    }
    CAPTURE(local);
    CHECK((places[0] - places[1]).norm() <= 1e-6 * places[0].norm());
  }
}

}  // namespace local_joints_test
