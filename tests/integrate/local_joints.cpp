// Joints, springs and limits of parts whose nodes deform locally.
#include "catch.h"

#include <pliant/body/joints/all_joints.h>

#include "motion.h"
#include "spring_net.h"

using namespace pliant;

namespace {

Part& balloon(MultiBody& body, const std::string& name, const Vec3<double>& at, bool soft) {
  auto& part = body.add<Primitive<Ellipsoid>>(name, 2.0);
  part.make_shell().rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}}).place(at);
  if (soft) part.stiffness({{"a1", 500}, {"a2", 500}, {"a3", 400}});
  LocalSettings settings = test::net(3, 60);
  settings.velocity = test::rush;
  part.deform_locally(settings);
  return part;
}

double widest(const Simulation& simulation) {
  double gap = 0;
  for (std::size_t j = 0; j < simulation.model().joints().size(); ++j)
    gap = std::max(gap, simulation.model().gap(simulation.state(), static_cast<int>(j)));
  return gap;
}

}  // namespace

TEST_CASE("soft shells hung from each other: joints hold, and the order is kept", "[local][joints]") {
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
        REQUIRE(widest(simulation) <= 1e-11);
      }
      energy.push_back(std::abs(simulation.ledger().energy() - start));
    }
    CAPTURE(soft, energy[0], energy[1], energy[2]);
    CHECK(test::observed_order(energy) >= 3.8);
    CHECK(energy.back() <= 1e-4);
  }
}

TEST_CASE("soft shells on joints: the augmented matrix and the blocks agree", "[local][joints]") {
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

TEST_CASE("a parameter of a soft shell that meets its limit: P and L stay, no energy comes in",
          "[local][limits]") {
  MultiBody body;
  body.gravity.setZero();
  Part& part = balloon(body, "ball", {0, 0, 0}, true);
  part.limits("a1", {0.45, 0.52}).initial_rate({{"a1", 0.5}}).move({0.1, 0, 0}, {0.2, 0.1, 0.3});
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
    // Semi-implicit Euler keeps P and L of turning parts to its order only.
    const double rounding = std::string(method) == "rk4" ? 1e-8 : 2e-3;
    CHECK((end.momentum - start.momentum).norm() <= rounding * start.momentum.norm());
    CHECK((end.angular_momentum - start.angular_momentum).norm() <= rounding * start.angular_momentum.norm());
  }
}

TEST_CASE("a soft shell on a string: it goes taut, and the gap stays closed", "[local][joints]") {
  MultiBody body;
  Part& part = balloon(body, "ball", {0.4, 0, -0.4}, false);
  body.join("cord", String{0.6}, {world(0, 0, 0), point(part, kPi / 2, 0)});
  Simulation simulation(body, "rk4");
  bool taut = false;
  for (int i = 0; i < 1500; ++i) {
    simulation.step(1e-3);
    REQUIRE(widest(simulation) <= 1e-9);
    taut = taut || simulation.state().joints[0] == JointMode::closed;
  }
  CHECK(taut);
}
