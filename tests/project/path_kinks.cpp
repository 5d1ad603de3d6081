// Moving anchors whose velocity jumps, because the path has a kink: the impulse of the jump, and its work.
#include "catch.h"

#include <sstream>

#include <Eigen/Geometry>

#include <pliant/body/joints/string.h>

#include "motion.h"

namespace path_kinks_test {

using namespace pliant;

namespace {

constexpr int kAnchors = static_cast<int>(Work::anchors);

/// Adds an ellipsoid with semi-axes of 0.3, 0.1 and 0.1 m and its long axis along x. A ball joint connects
/// one end of this axis with a moving anchor that starts at the origin.
Part& driven_ellipsoid(MultiBody& body, const TimeVector& path) {
  Part& part = test::add(body, "held", "ellipsoid", {}, 1000);
  part.rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.1}}).place({0.3, 0, 0});
  body.ball("hand", point(part, 0, kPi), world(path));
  return part;
}

/// Returns a path along z that starts to move at the time `start` (s) with `speed` (m/s). If `duration` (s)
/// is positive, the path stops after this time.
TimeVector lift(double start, double speed, double duration = 0) {
  if (duration > 0) return {0, 0, TimeFunction::key_frames({start, start + duration}, {0, duration * speed})};
  std::ostringstream text;
  text.precision(17);
  text << speed << " * max(t - " << start << ", 0)";
  return {0, 0, TimeFunction::formula(text.str())};
}

void advance_to(Simulation& simulation, double end, double step) {
  if (simulation.tolerance() > 0)
    while (simulation.time() < end) simulation.step_up_to(end);
  else
    test::run(simulation, end, static_cast<int>(std::lround(end / step)));
}

}  // namespace

TEST_CASE("an anchor that starts to move suddenly gives an impulse, and the ledger records its work",
          "[joints]") {
  const double m = 1000 * 4. / 3 * kPi * 0.3 * 0.1 * 0.1, I = m / 5 * (0.09 + 0.01), speed = 0.8;
  const double push = speed / (1 / m + 0.09 / I);
  struct Case {
    const char* method;
    double tolerance;
  };
  for (const auto& [method, tolerance] : {Case{"rk4", 0},
                                          {"semi_implicit_euler", 0},
                                          {"implicit_midpoint", 0},
                                          {"linearly_implicit", 0},
                                          {"dop853", 1e-9},
                                          {"esdirk", 1e-9},
                                          {kAutomatic, 1e-9}})
    for (const double start : {0.2, 0.20371, 0.2 + 3e-17, 1. / 3}) {
      for (const double duration : {0., 1.}) {
        INFO(method << ", at " << start << " for " << duration);
        MultiBody body;
        body.gravity.setZero();
        driven_ellipsoid(body, lift(start, speed, duration));
        Simulation simulation(body, method, 1, tolerance);
        advance_to(simulation, 0.2, 1e-3);
        advance_to(simulation, tolerance > 0 ? 0.34 : 0.14, 1e-3);
        REQUIRE(simulation.engage_impulses().size() == 1);
        const ImpulseOnEngage& impulse = simulation.engage_impulses().front();
        CHECK(impulse.of_path);
        CHECK(impulse.time == Approx(start).epsilon(1e-14));
        CHECK((impulse.impulse.force - Vec3<double>(0, 0, push)).norm() <= 1e-9 * push);
        const Ledger ledger = simulation.ledger();
        CHECK(ledger.work[kAnchors] >= push * speed / 2);
        const bool coarse = method == std::string("semi_implicit_euler");
        CHECK(std::abs(ledger.balance) <= (coarse ? 1e-2 : 1e-6) * push * speed);
        CHECK(simulation.model().gap(simulation.state(), 0) <= 1e-13);
      }
    }
}

TEST_CASE("anchors that start and stop suddenly: the balance stays within the error of the method",
          "[joints]") {
  // Gravity acts, so that the parts also move between the kinks.
  auto balance = [](const char* method, double step, double tolerance, auto&& make) {
    MultiBody body;
    make(body);
    Simulation simulation(body, method, 1, tolerance);
    double worst = 0;
    if (tolerance > 0) {
      while (simulation.time() < 1) {
        simulation.step_up_to(1);
        worst = std::max(worst, std::abs(simulation.ledger().balance));
      }
    } else {
      for (int i = 0; i < std::lround(1 / step); ++i) {
        simulation.step(step);
        worst = std::max(worst, std::abs(simulation.ledger().balance));
      }
    }
    CHECK_FALSE(simulation.engage_impulses().empty());
    return worst;
  };
  auto by_hand = [](MultiBody& body) { driven_ellipsoid(body, lift(0.2, 0.8, 0.6)); };
  auto to_and_fro = [](MultiBody& body) {
    driven_ellipsoid(body, {0, TimeFunction::formula("0.1 * abs(sin(7 * t))"),
                            TimeFunction::formula("0.3 * abs(t - 0.4) - 0.12")});
  };
  auto on_a_carrier = [](MultiBody& body) {
    Part& carrier = test::add(body, "carrier", "box", {}, 1000);
    PrescribedMotion motion;
    motion.position = {TimeFunction::formula("0.2 * max(t - 0.3, 0)"), 0, 0};
    motion.axis = {0, 1, 0};
    motion.angle = TimeFunction::key_frames({0.5, 0.9}, {0, 0.4});
    carrier.prescribe(motion);
    Part& a = test::add(body, "a", "ellipsoid", {}, 1000);
    Part& b = test::add(body, "b", "ellipsoid", {}, 500);
    a.rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.1}}).place({1.3, 0, 0});
    b.rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.1}}).place({1.9, 0, 0});
    carrier.prepare();
    a.prepare();
    body.ball("first", point(a, 0, kPi),
              point(carrier, carrier.label({1, 0, 0}, carrier.parameters().rest())));
    body.ball("second", point(b, 0, kPi), point(a, 0, 0));
  };
  for (const char* method : {"rk4", "implicit_midpoint"})
    for (const double step : {1e-3, 1.7e-3}) {
      INFO(method << " with steps of " << step);
      const double allowed = method == std::string("rk4") ? 1e-6 : 1e-2;
      CHECK(balance(method, step, 0, by_hand) <= allowed);
      CHECK(balance(method, step, 0, to_and_fro) <= allowed);
      CHECK(balance(method, step, 0, on_a_carrier) <= allowed);
    }
  for (const char* method : {"dop853", "esdirk", kAutomatic}) {
    INFO(method);
    CHECK(balance(method, 0, 1e-9, by_hand) <= 1e-6);
    CHECK(balance(method, 0, 1e-9, to_and_fro) <= 1e-6);
    CHECK(balance(method, 0, 1e-9, on_a_carrier) <= 1e-6);
  }
}

TEST_CASE("the ledger records the work of an anchor that suddenly pulls a taut string", "[joints]") {
  MultiBody body;
  Part& bob = test::add(body, "bob", "sphere", {}, 1000);
  bob.rest({{"r", 0.1}}).place({0, 0, -1});
  body.join("string", String{1}, {point(bob, 0, 0, 0), world(lift(0.3333, 0.7))});
  Simulation simulation(body, "rk4");
  test::run(simulation, 1, 500);
  const double m = 1000 * 4. / 3 * kPi * 1e-3, t = 1 - 0.3333;
  REQUIRE(simulation.engage_impulses().size() == 1);
  CHECK(simulation.state().v[2] == Approx(0.7));
  CHECK(simulation.ledger().work[kAnchors] == Approx(m * 0.7 * 0.7 / 2 + m * 9.81 * 0.7 * t).epsilon(1e-9));
  CHECK(std::abs(simulation.ledger().balance) <= 1e-9);
}

TEST_CASE(
    "a path with a position jump stops the run while its joint is closed, and the message names the joint",
    "[joints]") {
  for (const double tolerance : {0., 1e-6}) {
    MultiBody body;
    driven_ellipsoid(body, {0, 0, TimeFunction::formula("0.01 * step(t - 0.5)")});
    Simulation simulation(body, tolerance > 0 ? "dop853" : "rk4", 1, tolerance);
    try {
      advance_to(simulation, 1, 1e-3);
      FAIL("the run did not stop");
    } catch (const UnsatisfiableModel& failure) {
      CHECK_THAT(failure.what(),
                 test::has_text("at t = 0.5 s ball 'hand' would be torn open: the path of its end jumps"));
      CHECK(simulation.time() <= 0.5);
    }
  }
}

TEST_CASE("a run resumed from a state at a kink gives identical bits", "[joints]") {
  MultiBody one, two;
  driven_ellipsoid(one, lift(0.2, 0.8, 0.3));
  driven_ellipsoid(two, lift(0.2, 0.8, 0.3));
  Simulation unbroken(one, "rk4"), resumed(two, "rk4");
  for (int i = 0; i < 20; ++i) unbroken.step(0.01);
  resumed.set_state(unbroken.state());
  for (int i = 0; i < 50; ++i) {
    unbroken.step(0.01);
    resumed.step(0.01);
  }
  CHECK(hash(unbroken.state()) == hash(resumed.state()));
}

TEST_CASE("impulses of rejected steps are not kept", "[joints]") {
  MultiBody body;
  driven_ellipsoid(body, lift(0.2, 0.8, 0.3));
  Simulation simulation(body, "rk4");
  const State start = simulation.state();
  test::run(simulation, 1, 100);
  CHECK(simulation.engage_impulses().size() == 2);
  simulation.set_state(start);
  CHECK(simulation.engage_impulses().empty());
  test::run(simulation, 0.3, 30);
  CHECK(simulation.engage_impulses().size() == 1);
  // A step that fails where the path jumps has passed a kink before the jump.
  MultiBody torn;
  driven_ellipsoid(torn, {0, 0, TimeFunction::formula("0.8 * max(t - 0.49, 0) + 0.2 * step(t - 0.5)")});
  Simulation fails(torn, "rk4");
  for (int i = 0; i < 24; ++i) fails.step(0.02);
  CHECK_THROWS_AS(fails.step(0.03), UnsatisfiableModel);
  CHECK(fails.engage_impulses().empty());
  CHECK(fails.time() == Approx(0.48));
}

TEST_CASE("a spring acts between its times only, and the ledger counts its switching", "[springs]") {
  struct Case {
    const char* method;
    double tolerance;
  };
  for (const auto& [method, tolerance] : {Case{"rk4", 0}, Case{"dop853", 1e-10}}) {
    INFO(method);
    MultiBody body, free;
    for (MultiBody* each : {&body, &free}) {
      each->gravity.setZero();
      test::add(*each, "egg", "ellipsoid", {}, 100)
          .rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.1}})
          .velocity({0.5, 0, 0}, {0, 0.3, 1});
    }
    Spring& spring = body.spring("pull", point(*body.parts()[0], 0.3, 0.2), world(1, 1, 0), 300, 5, 0.2);
    spring.on = 0.2;
    spring.off = 0.6137;
    Simulation simulation(body, method, 1, tolerance), without(free, method, 1, tolerance);
    const auto run_to = [](Simulation& each, double end) {
      if (each.tolerance() > 0)
        while (each.time() < end) each.step_up_to(end);
      else
        test::run(each, end - each.time(), static_cast<int>(std::lround((end - each.time()) / 1e-3)));
    };
    run_to(simulation, 0.1);
    run_to(without, 0.1);
    CHECK(simulation.state().q == without.state().q);  // the choice of steps does not depend on the spring
    CHECK(simulation.ledger().springs == 0);
    run_to(simulation, 0.3);
    const double pulled = simulation.ledger().springs;
    CHECK(pulled > 0.5);
    CHECK(simulation.ledger().work[kAnchors] > 0.5 * pulled);
    CHECK(std::abs(simulation.ledger().balance) <= 1e-6 * simulation.ledger().work.cwiseAbs().sum());
    run_to(simulation, 1);
    const Ledger ledger = simulation.ledger();
    CHECK(ledger.springs == 0);
    CHECK(std::abs(ledger.balance) <= 1e-6 * ledger.work.cwiseAbs().sum());
    CHECK(ledger.kinetic != Approx(without.ledger().kinetic).epsilon(1e-3));
    // The speed does not change after the end of the spring.
    const Vec3<double> speed = simulation.state().v.head<3>();
    run_to(simulation, 1.2);
    CHECK((simulation.state().v.head<3>() - speed).norm() <= 1e-9);
  }
}

TEST_CASE("no step crosses a multiple of 1 / stop_rate", "[springs]") {
  MultiBody body;
  body.stop_rate = 7;
  test::add(body, "egg", "ellipsoid", {}, 100).velocity({0.5, 0, 0}, {0, 0.3, 1});
  Simulation simulation(body, "dop853", 1, 1e-8);
  int stops = 0;
  while (simulation.time() < 2) {
    const double before = simulation.time();
    simulation.step_up_to(2);
    CHECK(std::floor(simulation.time() * 7 - 1e-9) == std::floor(before * 7 + 1e-9));
    stops += std::abs(simulation.time() * 7 - std::round(simulation.time() * 7)) < 1e-12 ? 1 : 0;
  }
  CHECK(stops == 14);
  const Model& model = simulation.model();
  CHECK(model.next_kink(0, 10).time == 1. / 7);
  CHECK(model.next_kink(1. / 7, 10).time == 2. / 7);
  CHECK_FALSE(std::isfinite(model.next_kink(1. / 7, 0.28).time));
}

}  // namespace path_kinks_test
