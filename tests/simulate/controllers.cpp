// Controllers: functions of the program that set inputs at the start of each step.
#include "catch.h"

#include <pliant/body/actuation/named_signal.h>

#include "motion.h"

namespace controllers_test {

using namespace pliant;

namespace {

constexpr double kMass = 2;  // kg

/// Adds a ball at x = 0.3 m, a force on the ball along x (the input "push"), and a sensor of x.
void add_pushed_ball(MultiBody& body) {
  body.gravity.setZero();
  Part& ball = body.add<Primitive<Sphere>>("ball");
  ball.rest({{"r", 0.5}}).mass(kMass).place({0.3, 0, 0});
  body.input("push");
  body.force("thrust", point(ball, 0, 0, 0), StateVector(state_formula(body, "push"), 0, 0));
  body.sensor("x", state_formula(body, "ball.x"));
}

}  // namespace

TEST_CASE("a controller is a sampled feedback: its force is constant in each step", "[actuation]") {
  for (const char* method : {"rk4", "semi_implicit_euler", "dop853"}) {
    MultiBody body;
    add_pushed_ball(body);
    Simulation simulation(body, method);
    int calls = 0;
    simulation.set_controller([&](double t, const State& state, Eigen::Ref<VecX<double>> inputs) {
      CHECK(t == state.time());
      CHECK(simulation.sensors()[0] == state.q[0]);
      inputs[0] = -20 * state.q[0] - 4 * state.v[0];
      ++calls;
    });
    // The exact motion under a constant force; semi-implicit Euler moves with the velocity at the end.
    const double h = 0.02;
    double x = 0.3, v = 0;
    for (int i = 0; i < 50; ++i) {
      const double a = (-20 * x - 4 * v) / kMass;
      x += h * (v + (method == std::string("semi_implicit_euler") ? h : 0.5 * h) * a);
      v += h * a;
      simulation.step(h);
      CAPTURE(method, i);
      REQUIRE(simulation.state().q[0] == Approx(x).margin(1e-13));
      REQUIRE(simulation.state().v[0] == Approx(v).margin(1e-13));
    }
    CHECK(calls == 50);
  }
}

TEST_CASE("with a tolerance a controller keeps its sampling time, and the ledger has its work",
          "[actuation]") {
  MultiBody body;
  add_pushed_ball(body);
  Simulation simulation(body, "dop853", 1, 1e-10);
  int calls = 0;
  simulation.set_controller([&](double, const State& state, Eigen::Ref<VecX<double>> inputs) {
    inputs[0] = -20 * state.q[0];
    ++calls;
  });
  const double h = 0.05;
  double x = 0.3, v = 0;
  for (int i = 0; i < 20; ++i) {
    const double a = -20 * x / kMass;
    x += h * (v + 0.5 * h * a);
    v += h * a;
    simulation.step(h);
  }
  CHECK(simulation.state().q[0] == Approx(x).margin(1e-9));
  CHECK(calls >= 20);
  CHECK(std::abs(simulation.ledger().balance) <= 1e-9);
}

}  // namespace controllers_test
