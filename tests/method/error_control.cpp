// Steps with error control: the error follows the tolerance, steps end exactly at requested times, a resumed
// run gives identical bits, impacts are located, and failures are reported. The automatic choice of the
// method is also tested.
// N25 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <ctime>
#include <functional>
#include <limits>
#include <string>

#include <pliant/body/joints/string.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/project/project.h>
#include <pliant/simulate/choose_integrator.h>

#include "motion.h"

namespace error_control_test {

using namespace pliant;

namespace {

void pendulum(MultiBody& body) {
  Part& part = body.add<Primitive<Ellipsoid>>("link");
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).place({0.3, 0, 0}).velocity({0, 0.6, 0}, {0, 0, 2});
  body.ball("joint", world(0, 0, 0), point(part, 0, kPi));
}

/// Returns the state at the time `end` (s) of a run with a tolerance. counters: receives the counters of the
/// run.
State end_of(const std::function<void(MultiBody&)>& build, const std::string& method, double tolerance,
             double end, StepCounters* counters = nullptr) {
  MultiBody body;
  build(body);
  Simulation simulation(body, method, 1, tolerance);
  while (simulation.time() < end) simulation.step_up_to(end);
  CHECK(simulation.time() == end);
  if (counters != nullptr) *counters = simulation.step_counters();
  return simulation.state();
}

/// Adds a shell that swings on a ball joint. Its vibrations decay within a few milliseconds.
void stiff_pendulum(MultiBody& body) {
  Part& part = body.add<Primitive<Sphere>>("shell", 1.0);
  part.rest({{"r", 0.5}}).make_shell();
  LocalSettings settings;
  settings.resolution = 2;
  settings.energies = {local_law("membrane", {1e8, 0.3, 0.01})};
  settings.beta = 1e-4;
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return {X[1] * X[2], 0, 0}; };
  part.deform_locally(settings).velocity({0, 0.5, 0}, {0.1, 0.2, 0.3});
  body.ball("string", world(0, 0, 0.5), point(part, kPi / 2, 0));
}

/// Adds a ball with a force that acts from 0.1 s on and changes its sign more often than any step can
/// resolve.
void noisy_ball(MultiBody& body) {
  Part& part = body.add<Primitive<Sphere>>("ball");
  body.force("noise", point(part, 0, 0), [](double t, const Vec3<double>&, const Vec3<double>&) {
    const double noise = std::sin(1e20 * t) > 0 ? 1e9 : -1e9;
    return Vec3<double>(t < 0.1 ? 0 : noise, 0, 0);
  });
}

}  // namespace

TEST_CASE("errors follow the tolerance", "[error]") {
  const State exact = end_of(pendulum, "dop853", 1e-12, 3);
  for (const std::string& method : controlled_integrators()) {
    const bool low = make_integrator(method)->order() == 2;
    double before = 1;
    for (double tolerance = 1e-4; tolerance > (low ? 2e-7 : 2e-9); tolerance *= 0.1) {
      const State end = end_of(pendulum, method, tolerance, 3);
      const double error = (end.q - exact.q).norm();
      CAPTURE(method, tolerance, error);
      CHECK(error < 300 * tolerance);
      CHECK(error < before);
      before = error;
    }
  }
}

TEST_CASE(
    "steps with error control end exactly at given times, and a shortened step does not shorten the next",
    "[error]") {
  MultiBody body;
  pendulum(body);
  Simulation free(body, "dop853", 1, 1e-8);
  while (free.time() < 1) free.step_up_to(1);
  MultiBody other;
  pendulum(other);
  Simulation shortened(other, "dop853", 1, 1e-8);
  shortened.step_up_to(0.5);
  const double free_step = shortened.state().h;
  shortened.step(1e-6);
  CHECK(shortened.state().h >= free_step);
  MultiBody third;
  pendulum(third);
  Simulation frames(third, "dop853", 1, 1e-8);
  for (int i = 1; i <= 25; ++i) frames.step(0.04);
  CHECK(frames.time() == Approx(1).epsilon(1e-14));
  CHECK((frames.state().q - free.state().q).norm() < 1e-6);
  CHECK_THROWS_AS(frames.step_up_to(0.5), std::invalid_argument);
}

TEST_CASE("a run with error control, resumed from a state, gives identical bits", "[error]") {
  for (const std::string& method : controlled_integrators()) {
    CAPTURE(method);
    MultiBody body, other;
    test::tumbling_solid(body);
    test::tumbling_solid(other);
    Simulation unbroken(body, method, 1, 1e-6), resumed(other, method, 1, 1e-6);
    while (unbroken.time() < 0.02) unbroken.step_up_to(10);
    resumed.set_state(unbroken.state());
    for (int i = 0; i < 5; ++i) {
      unbroken.step_up_to(10);
      resumed.step_up_to(10);
    }
    CHECK(hash(unbroken.state()) == hash(resumed.state()));
  }
}

TEST_CASE("a resumed run gives identical bits while joints close at a rate that depends on the step",
          "[error]") {
  const char* method = GENERATE("dormand_prince", "dop853");
  MultiBody body;
  body.stabilization.rule = BaumgarteRule::step_consistent;
  const Part* before = nullptr;
  for (int i = 0; i < 3; ++i) {
    Part& link = test::add(body, "link" + std::to_string(i), "box", {}, 1000);
    link.rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.5}}).place({0.3 * i, 0.1 * i, -1.2 * i - 0.8});
    body.ball("joint" + std::to_string(i), point(link, kPi / 2, 0),
              before == nullptr ? world(0, 0, 0) : point(*before, -kPi / 2, 0));
    before = &link;
  }
  Simulation simulation(body, method, 1, 1e-6);
  bool closing = false;
  for (int i = 0; i < 100; ++i) {
    Simulation other(body, method, 1, 1e-6);
    other.set_state(simulation.state());
    simulation.step_up_to(100);
    other.step_up_to(100);
    closing = closing || simulation.state().joints[0] == JointMode::closing;
    REQUIRE(other.state().q == simulation.state().q);
    REQUIRE(other.state().v == simulation.state().v);
  }
  CHECK(closing);
}

TEST_CASE("N25: a motion that no step can resolve stops the run, with the last good state kept", "[error]") {
  MultiBody body;
  noisy_ball(body);
  Simulation simulation(body, "dop853", 1, 1e-9);
  try {
    while (simulation.time() < 1) simulation.step_up_to(1);
    FAIL("expected the run to fail, because no step can resolve the motion");
  } catch (const NumericalFailure& failure) {
    CHECK_THAT(failure.what(), test::has_text("tolerance"));
  }
  CHECK(simulation.time() > 0.05);
  CHECK(simulation.state().q.allFinite());
}

TEST_CASE("meaningless tolerances, and methods without an error estimate, are refused", "[error]") {
  for (const double tolerance : {-1.0, 1e-13, 0.5, std::numeric_limits<double>::quiet_NaN()}) {
    MultiBody body;
    pendulum(body);
    CHECK_THROWS_AS(Simulation(body, "dop853", 1, tolerance), std::invalid_argument);
  }
  MultiBody body;
  pendulum(body);
  try {
    Simulation simulation(body, "rk4", 1, 1e-6);
    FAIL("expected a refusal, because rk4 has no error estimate");
  } catch (const std::invalid_argument& failure) {
    CHECK_THAT(failure.what(), test::has_text("'dop853'"));
  }
  MultiBody fixed;
  pendulum(fixed);
  Simulation simulation(fixed, "dop853");
  CHECK_THROWS_AS(simulation.step_up_to(1), std::logic_error);
}

TEST_CASE("a string becomes taut as accurately as the tolerance asks", "[error]") {
  // A ball falls until its string is taut, 0.5 s later.
  auto build = [](MultiBody& body) {
    Part& ball = body.add<Primitive<Sphere>>("ball");
    ball.rest({{"r", 0.1}});
    body.join("string", String{0.5 * 9.81 * 0.25 + 0.1}, {world(0, 0, 0.1), point(ball, 0, 0, 0)});
  };
  for (const double tolerance : {1e-5, 1e-7}) {
    MultiBody body;
    build(body);
    Simulation simulation(body, "dop853", 1, tolerance);
    while (simulation.time() < 1) simulation.step_up_to(1);
    CAPTURE(tolerance, simulation.step_counters().rejected);
    CHECK(simulation.state().q[2] == Approx(-0.5 * 9.81 * 0.25).margin(20 * tolerance));
    CHECK(std::abs(simulation.state().v[2]) < 1e-9);
    CHECK(simulation.ledger().balance == Approx(0).margin(100 * tolerance));
  }
}

TEST_CASE("joints close as accurately as the tolerance asks", "[error]") {
  auto closing = [](MultiBody& body) {
    Part& part = body.add<Primitive<Ellipsoid>>("link");
    part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).place({0.5, 0.2, 0}).velocity({0, 0.6, 0}, {0, 0, 2});
    body.ball("joint", world(0, 0, 0), point(part, 0, kPi));
  };
  constexpr double opens = 0.5, closes = 2;  // s; the joint closes between these times
  for (const std::string& method : controlled_integrators()) {
    const bool low = make_integrator(method)->order() == 2;
    for (const double end : {opens, closes}) {
      const State exact = end_of(closing, "dop853", 1e-12, end);
      const JointMode mode = end == opens ? JointMode::closing : JointMode::closed;
      REQUIRE(exact.joints[0] == mode);
      for (double tolerance = kClosedGap; tolerance > (low ? 2e-6 : 2e-8); tolerance *= 0.1) {
        const State state = end_of(closing, method, tolerance, end);
        CAPTURE(method, tolerance, end);
        CHECK(state.joints[0] == mode);
        CHECK((state.q - exact.q).norm() < 100 * tolerance);
      }
    }
  }
}

TEST_CASE("the swing of a stiff shell, not its stiffness, limits the steps, and factors are reused",
          "[error]") {
  constexpr double end = 0.5;
  StepCounters explicit_counters;
  const State exact = end_of(stiff_pendulum, "dop853", 1e-8, end, &explicit_counters);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    StepCounters counters;
    const State state = end_of(stiff_pendulum, "linearly_implicit", tolerance, end, &counters);
    CAPTURE(tolerance, counters.steps, counters.factorisations);
    CHECK((state.q - exact.q).lpNorm<Eigen::Infinity>() < 10 * tolerance);
    CHECK(5 * counters.steps < explicit_counters.steps);
    CHECK(counters.factorisations < 15);
  }
}

TEST_CASE("a stiff shell that spins is integrated to the tolerance, with few changes of the step",
          "[error]") {
  auto spin = [](MultiBody& body) {
    body.gravity.setZero();
    Part& part = body.add<Primitive<Ellipsoid>>("shell");
    part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.3}}).make_shell();
    LocalSettings settings;
    settings.resolution = 2;
    settings.energies = {local_law("membrane", {1e7, 0.3, 0.01})};
    settings.beta = 1e-4;
    part.deform_locally(settings).velocity({0, 0, 0}, {1, 2, 3});
  };
  constexpr double end = 3;  // s, nearly two rotations
  const State exact = end_of(spin, "dop853", 1e-9, end);
  for (const double tolerance : {1e-2, 1e-3, 1e-4}) {
    StepCounters counters;
    const State state = end_of(spin, "linearly_implicit", tolerance, end, &counters);
    CAPTURE(tolerance, counters.steps, counters.factorisations);
    CHECK((state.q.segment<4>(3) - exact.q.segment<4>(3)).norm() < 5 * tolerance);
    CHECK((state.v.segment<6>(0) - exact.v.segment<6>(0)).norm() < 50 * tolerance);
    CHECK(counters.factorisations < 15);
  }
}

TEST_CASE("the trials for the choice of a method can be stopped, and have a limited number of evaluations",
          "[error]") {
  MultiBody body;
  test::tumbling_solid(body);
  int calls = 0;
  CHECK_THROWS_AS(Simulation(body, kAutomatic, 1, 1e-6, [&] { return ++calls > 10; }), ChoiceStopped);
  CHECK(calls == 11);
  // If nothing stops them, the trials of the candidates have at least 96 steps in all.
  MultiBody whole;
  test::tumbling_solid(whole);
  int unlimited = 0;
  Simulation(whole, kAutomatic, 1, 1e-6, [&] { return ++unlimited < 0; });
  CHECK(unlimited >= 96);
  CHECK(evaluation_cost(*body.parts()[0]) > 0);
}

TEST_CASE("the trials of a large model end after some seconds", "[error][long]") {
  // Each evaluation takes about 20 ms. Without a limit, the trials take at least 96 steps of 12 evaluations.
  MultiBody body;
  for (int i = 0; i < 20; ++i) {
    Part& part = test::add(body, "part" + std::to_string(i), "cylinder", {"bend", "twist"}, 1000);
    part.rest({{"a1", 0.2}, {"a2", 0.2}}).limits("bend.angle", {-2, 2}).place({2.0 * i, 0, 0});
    part.stiffness({{"a1", 1e4}, {"bend.angle", 1e3}, {"twist.angle", 1e3}});
  }
  int steps = 0;
  const std::clock_t start = std::clock();
  const Simulation simulation(body, kAutomatic, 1, 1e-6, [&] { return ++steps < 0; });
  const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  CAPTURE(steps, seconds, simulation.choice().why);
  CHECK(steps >= 2);
  CHECK(steps < 60);
#ifndef PLIANT_SANITIZED
  CHECK(seconds < 30);
#endif
}

TEST_CASE("the method is chosen by the stiffness of the model, the tolerance and the contacts", "[error]") {
  auto chosen = [](const std::function<void(MultiBody&)>& build) {
    MultiBody body;
    build(body);
    const Simulation simulation(body, kAutomatic);
    CHECK(simulation.tolerance() == kStandardTolerance);
    CHECK(simulation.choice().integrator == simulation.integrator().name());
    INFO(simulation.choice().why);
    return simulation.choice().integrator;
  };
  CHECK(chosen(pendulum) == "dop853");
  CHECK(chosen([](MultiBody& body) { test::tumbling_solid(body); }) == "dop853");
  MultiBody dust;  // its parameters are dynamic, without elasticity
  Part& cloud = dust.add<Primitive<Ellipsoid>>("dust");
  cloud.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).make_dynamic({"a1", "a2", "a3"});
  cloud.velocity({0, 0, 0}, {1, 2, 3});
  for (const double tolerance : {0.1, 1e-2, 1e-6}) {
    const Simulation simulation(dust, kAutomatic, 1, tolerance);
    CHECK(simulation.choice().integrator == "dop853");
    CHECK(simulation.choice().why == "nothing is elastic or damped");
  }
  CHECK(chosen([](MultiBody& body) {
          Part& part = body.add<Primitive<Ellipsoid>>("stiff");
          part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}});
          part.stiffness({{"a1", 1e10}, {"a2", 1e10}, {"a3", 1e10}}).damping(0, 1e-3);
          part.velocity({0, 0, 0}, {1, 2, 3});
          body.ball("joint", world(0.3, 0, 0), point(part, 0, 0));
        }) == "esdirk");
  MultiBody stiff;
  stiff_pendulum(stiff);
  CHECK(Simulation(stiff, kAutomatic, 1, 1e-2).choice().integrator == "linearly_implicit");
  CHECK(Simulation(stiff, kAutomatic, 1, 1e-4).choice().integrator == "linearly_implicit");
  CHECK(Simulation(stiff, kAutomatic, 1, 1e-8).choice().integrator == "dop853");
  MultiBody dropped;
  dropped.add<Primitive<Sphere>>("ball").place({0, 0, 1});
  dropped.contact.active = true;
  CHECK(Simulation(dropped, kAutomatic, 1, 1e-2).choice().integrator == "dormand_prince");
  CHECK(Simulation(dropped, kAutomatic, 1, 1e-6).choice().integrator == "dormand_prince");
  CHECK(Simulation(dropped, kAutomatic, 1, 1e-7).choice().integrator == "dop853");
}

TEST_CASE("with error control, impacts are located within the tolerance", "[error]") {
  // A ball dropped from 1 m rebounds with e = 0.8 of its impact speed. The first bounce is at the time T of
  // the fall, and the k-th bounce after it at T (1 + 2 e + ... + 2 e^k).
  MultiBody body;
  body.add<Primitive<Sphere>>("ball").rest({{"r", 0.1}}).place({0, 0, 1.1});
  body.contact.active = true;
  body.contact.restitution = 0.8;
  body.contact.planes.emplace_back().name = "floor";
  Simulation simulation(body, "dop853", 1, 1e-6);
  while (simulation.time() < 2) simulation.step_up_to(2);
  const double fall = std::sqrt(2 / 9.81), speed = 9.81 * fall;
  double start = fall, up = speed;
  for (double flight = 0; start + flight < 2; flight = 2 * up / 9.81) {
    start += flight;
    up *= 0.8;
  }
  const double since = 2 - start;
  CHECK(simulation.state().q[2] == Approx(0.1 + up * since - 0.5 * 9.81 * since * since).margin(1e-9));
  CHECK(simulation.step_counters().impacts == 3);
  CHECK(simulation.step_counters().evaluations < 300);  // about four steps for each impact
  CHECK(simulation.step_counters().uncontrolled == 0);
  CHECK(simulation.step_counters().steps < 40);
}

TEST_CASE("the norm of an error is NaN if a block is NaN, also before blocks with finite errors",
          "[adaptive]") {
  MultiBody body;
  body.add<Primitive<Sphere>>("first", 1000);
  body.add<Primitive<Sphere>>("second", 1000);
  const Simulation simulation(body, "rk4");
  const ErrorScale scale(simulation.model(), 1e-3);
  const State& state = simulation.state();
  VecX<double> q_error = VecX<double>::Constant(state.q.size(), 0.1);
  const VecX<double> v_error = VecX<double>::Constant(state.v.size(), 0.1);
  q_error[0] = std::numeric_limits<double>::quiet_NaN();
  CHECK(std::isnan(scale.norm(q_error, v_error, state.v)));
  CHECK(std::isnan(scale.norm(q_error)));
  CHECK(scale.worst(q_error, v_error, state.v) == "the position of part 'first'");
}

}  // namespace error_control_test
