// The predicted largest stable step is compared with the measured largest stable step.
// N19 and N20 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <chrono>
#include <cmath>

#include <pliant/body/joints/rod.h>

#include "motion.h"

namespace stable_step_test {

using namespace pliant;

namespace {

using Build = std::function<void(MultiBody&)>;

/// Returns whether the motion about the initial state stays bounded in 3000 steps of h (s): no step fails,
/// and the norm of v stays below 1000 times the sum of its initial value and 1e-6.
bool bounded(const Build& build, const char* method, double h) {
  MultiBody body;
  body.gravity.setZero();
  build(body);
  Simulation simulation(body, method);
  const double start = simulation.state().v.norm() + 1e-6;
  try {
    for (int i = 0; i < 3000; ++i) {
      simulation.step(h);
      if (simulation.state().v.norm() > 1e3 * start) return false;
    }
  } catch (const NumericalFailure&) {
    return false;
  }
  return true;
}

/// Checks that steps of 0.98 times the predicted limit are stable and that steps of 1.02 times this limit are
/// not. what: name of the model.
void check_limit(const std::string& what, const Build& build) {
  for (const char* method : {"semi_implicit_euler", "rk4", "linearly_implicit"}) {
    MultiBody body;
    body.gravity.setZero();
    build(body);
    const double predicted = largest_stable_step(Simulation(body, method));
    INFO(what << " " << method << " predicted " << predicted);
    CHECK(bounded(build, method, 0.98 * predicted));
    CHECK_FALSE(bounded(build, method, 1.02 * predicted));
  }
}

/// Returns a function that adds a solid with one elastic semi-axis. stiffness: N/m; alpha: 1/s; beta: s;
/// drag: 1/s. The motion is so small that the semi-axis does not reach its limits.
Build breathing(double stiffness, double alpha, double beta, double drag = 0) {
  return [=](MultiBody& body) {
    auto& part = body.add<Primitive<Ellipsoid>>("body", 1000);
    part.mass(5).stiffness({{"a3", stiffness}}).initial_rate({{"a3", 1e-9}}).damping(alpha, beta, drag);
  };
}
/// Returns a function that adds a ball on a spring and damper at its centre. stiffness: N/m; damping: N s/m.
Build ball(double stiffness, double damping) {
  return [=](MultiBody& body) {
    auto& part = body.add<Primitive<Sphere>>("ball", 1000);
    part.mass(2).velocity({1e-9, 0, 0}, {0, 0, 0});
    body.spring("spring", point(part, 0, 0, 0), world(0, 0, 0), stiffness, damping);
  };
}

}  // namespace

TEST_CASE("N20: the predicted step of semi-implicit Euler agrees with the closed form", "[stable]") {
  // The method is stable for x'' + (alpha + beta omega^2) x' + omega^2 x = 0, omega^2 = 5 k / m, if
  // omega^2 h^2 + 2 h (alpha + beta omega^2) < 4.
  for (double k : {1.0, 1e4})
    for (double alpha : {0.0, 3.0})
      for (double beta : {0.0, 0.01}) {
        MultiBody body;
        body.gravity.setZero();
        breathing(k, alpha, beta)(body);
        const double w2 = k, d = alpha + beta * w2;
        const double expected = (-d + std::sqrt(d * d + 4 * w2)) / w2;
        CHECK(largest_stable_step(Simulation(body)) == Approx(expected).epsilon(1e-4));
      }
}

TEST_CASE("N20: the predicted step of RK4 on the imaginary and on the real axis", "[stable]") {
  {
    MultiBody body;
    breathing(100, 0, 0)(body);
    CHECK(largest_stable_step(Simulation(body, "rk4")) * 10 == Approx(2 * std::sqrt(2.0)).epsilon(1e-3));
  }
  {
    MultiBody body;
    breathing(1e-9, 50, 0)(body);
    CHECK(largest_stable_step(Simulation(body, "rk4")) * 50 == Approx(2.785).epsilon(1e-3));
  }
}

TEST_CASE("N20: measured limits agree with the predicted ones", "[stable]") {
  check_limit("scale", breathing(500, 0, 0));
  check_limit("scale, alpha", breathing(500, 8, 0));
  check_limit("scale, beta", breathing(500, 0, 0.05));
  check_limit("scale, drag", breathing(500, 0, 0.01, 5));
  check_limit("spring", ball(300, 0));
  check_limit("spring and damper", ball(300, 20));
  check_limit("strong damper", ball(300, 400));
}

TEST_CASE(
    "N20: measured limits agree with the predicted ones for two parts on a spring and for coupled parameters",
    "[stable]") {
  check_limit("two balls", [](MultiBody& body) {
    auto& a = body.add<Primitive<Sphere>>("a", 1000);
    auto& b = body.add<Primitive<Sphere>>("b", 1000);
    a.mass(1).velocity({1e-9, 0, 0}, {0, 0, 0});
    b.mass(3);
    body.spring("tie", point(a, 0, 0, 0), point(b, 0, 0, 0), 100, 2);
  });
  check_limit("hung at the pole", [](MultiBody& body) {
    auto& a = body.add<Primitive<Ellipsoid>>("a", 1000);
    a.mass(1).stiffness({{"a3", 60}}).velocity({0, 0, 1e-9}, {0, 0, 0});
    body.spring("string", point(a, material_at(kPi / 2, 0)), world(0, 0, 1), 200, 1);
  });
  check_limit("all parameters", [](MultiBody& body) {
    Part& part = test::add(body, "part", "box", {"taper", "shear"}, 1);
    part.rest({{"a1", 0.3}, {"taper.tx", 0.3}});
    part.stiffness({{"a1", 30}, {"a3", 20}, {"taper.tx", 3}, {"taper.ty", 1}, {"shear.sx", 4}});
    part.initial_rate({{"a1", 1e-9}, {"taper.ty", 1e-9}, {"shear.sx", 1e-9}});
  });
}

TEST_CASE("without stiffness and rotation the step is unlimited", "[stable]") {
  MultiBody body;
  body.add<Primitive<Box>>("box", 1000).velocity({1, 0, 0}, {0, 0, 0});
  CHECK(std::isinf(largest_stable_step(Simulation(body))));
}

TEST_CASE("N19: a spin limits the step to half a radian", "[stable]") {
  auto spinning = [](MultiBody& body) {
    auto& part = body.add<Primitive<Box>>("box", 1000);
    part.rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.3}}).velocity({0, 0, 0}, {30, 40, 120});
    body.gravity.setZero();
  };
  MultiBody body;
  spinning(body);
  CHECK(largest_stable_step(Simulation(body)) == Approx(0.5 / 130));
  // With far longer steps semi-implicit Euler conserves |L|, so that omega stays bounded in any direction.
  MultiBody euler_body;
  spinning(euler_body);
  Simulation simulation(euler_body, "semi_implicit_euler");
  const double L = simulation.ledger().angular_momentum.norm();
  for (int i = 0; i < 2000; ++i) simulation.step(10.0 / 130);
  CHECK(simulation.ledger().angular_momentum.norm() == Approx(L).epsilon(1e-9));
  // RK4 fails, and the message names a stable step.
  MultiBody rk4_body;
  spinning(rk4_body);
  Simulation rk4_run(rk4_body, "rk4");
  std::string message;
  try {
    for (int i = 0; i < 2000; ++i) rk4_run.step(10.0 / 130);
  } catch (const NumericalFailure& failure) {
    message = failure.what();
  }
  INFO(message);
  CHECK(message.find("the largest stable step at the start is about") != std::string::npos);
}

/// Adds a hanging chain of n small balls on rods of 1 m, and sets gravity to 1 m/s^2. velocity: initial
/// horizontal velocity of the last ball, m/s.
void hanging_chain(MultiBody& body, int n, double velocity = 0) {
  body.gravity = {0, 0, -1};
  const Part* above = nullptr;
  for (int i = 0; i < n; ++i) {
    auto& mass = body.add<Primitive<Sphere>>("mass" + std::to_string(i), 1000);
    mass.rest({{"r", 0.01}}).place({0, 0, -1.0 - i});
    if (i == n - 1) mass.velocity({velocity, 0, 0}, {0, 0, 0});
    body.join("rod" + std::to_string(i), Rod{1},
              {above == nullptr ? world(0, 0, 0) : point(*above, 0, 0, 0), point(mass, 0, 0, 0)});
    above = &mass;
  }
}

TEST_CASE(
    "N20: joints under load: the largest omega^2 of a hanging chain is the largest root of a Laguerre "
    "polynomial",
    "[stable]") {
  for (const auto& [n, root] : {std::pair<int, double>{1, 1}, {2, 3.414213562373}, {5, 12.640800844276}}) {
    MultiBody body;
    hanging_chain(body, n);
    INFO(n);
    CHECK(largest_stable_step(Simulation(body, "rk4")) == Approx(std::sqrt(8 / root)).epsilon(1e-3));
    CHECK(largest_stable_step(Simulation(body, "semi_implicit_euler")) ==
          Approx(2 / std::sqrt(root)).epsilon(1e-3));
  }
  // A pendulum in its unstable equilibrium does not limit the step. The hanging chain beside it does.
  MultiBody body;
  hanging_chain(body, 2);
  auto& top = body.add<Primitive<Sphere>>("top", 1000);
  top.rest({{"r", 0.01}}).place({5, 0, 0.01});
  body.join("rod", Rod{0.01}, {world(5, 0, 0), point(top, 0, 0, 0)});
  CHECK(largest_stable_step(Simulation(body, "rk4")) == Approx(std::sqrt(8 / 3.414213562373)).epsilon(1e-2));
}

TEST_CASE("N20: the predicted limit of a hanging chain agrees with the measured one", "[stable]") {
  for (const char* method : {"semi_implicit_euler", "rk4"}) {
    MultiBody body;
    hanging_chain(body, 5);
    const double predicted = largest_stable_step(Simulation(body, method));
    for (const double fraction : {0.95, 1.05}) {
      MultiBody displaced;
      hanging_chain(displaced, 5, 1e-9);
      Simulation simulation(displaced, method);
      double fastest = 0;
      try {
        for (int i = 0; i < 1000 && fastest < 1e-3; ++i) {
          simulation.step(fraction * predicted);
          fastest = std::max(fastest, simulation.state().v.norm());
        }
      } catch (const StepFailure&) {
        fastest = 1;
      }
      INFO(method << " at " << fraction << " of " << predicted);
      CHECK((fastest < 1e-6) == (fraction < 1));
    }
  }
}

TEST_CASE("N20: Baumgarte terms limit the step where a gap is not projected", "[stable]") {
  auto limit = [](const char* method, BaumgarteRule rule, bool projection) {
    MultiBody body;
    body.gravity.setZero();
    body.ball("joint", point(body.add<Primitive<Sphere>>("ball", 1000), 0, 0, 0), world(0, 0, 0));
    body.stabilization.rule = rule;
    body.stabilization.rate = 10;
    body.stabilization.projection = projection;
    return largest_stable_step(Simulation(body, method));
  };
  CHECK(limit("semi_implicit_euler", BaumgarteRule::critical, false) == Approx(0.0828427).epsilon(1e-4));
  CHECK(limit("rk4", BaumgarteRule::critical, false) == Approx(0.27853).epsilon(1e-4));
  CHECK(std::isinf(limit("rk4", BaumgarteRule::critical, true)));
  CHECK(std::isinf(limit("semi_implicit_euler", BaumgarteRule::step_consistent, false)));
}

TEST_CASE("long chains: the predicted step is safe, exact to some percent, and found quickly", "[stable]") {
  // The highest frequency of n balls in a row on springs that are not stretched: omega^2 = 4 k / m cos^2(pi /
  // (2 n)).
  auto chain = [](int n) {
    MultiBody body;
    body.gravity.setZero();
    std::vector<Part*> balls;
    for (int i = 0; i < n; ++i) {
      auto& ball = body.add<Primitive<Sphere>>("ball" + std::to_string(i), 1000);
      ball.mass(1).place({2.5 * i, 0, 0});
      balls.push_back(&ball);
      if (i > 0)
        body.spring("tie" + std::to_string(i), point(*balls[static_cast<std::size_t>(i) - 1], 0, 0),
                    point(ball, 0, kPi), 100, 0, 0.5);
    }
    return largest_stable_step(Simulation(body));
  };
  for (const int n : {2, 20, 200, 1000}) {
    const double exact = 2 / std::sqrt(400.0) / std::cos(kPi / (2.0 * n));
    INFO(n);
    const auto start = std::chrono::steady_clock::now();
    const double predicted = chain(n);
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
    CHECK(predicted <= exact * (1 + 1e-6));
    CHECK(predicted >= 0.95 * exact);
    CHECK(elapsed.count() < 10);
  }
}

}  // namespace stable_step_test
