// The predicted largest stable step against the measured one (N20, stress.md 1.1).
#include "catch.h"

#include <cmath>

#include "motion.h"

using namespace pliant;

namespace {

using Build = std::function<void(MultiBody&)>;

/// Whether the motion about the state stays bounded for steps of h.
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

void check_limit(const std::string& what, const Build& build) {
  for (const char* method : {"semi_implicit_euler", "rk4"}) {
    MultiBody body;
    body.gravity.setZero();
    build(body);
    const double predicted = largest_stable_step(Simulation(body, method));
    INFO(what << " " << method << " predicted " << predicted);
    CHECK(bounded(build, method, 0.98 * predicted));
    CHECK_FALSE(bounded(build, method, 1.02 * predicted));
  }
}

/// A scale of a solid with stiffness, and damping by alpha and beta; small enough a motion that no limit is
/// met.
Build breathing(double stiffness, double alpha, double beta, double drag = 0) {
  return [=](MultiBody& body) {
    auto& part = body.add<Primitive<Ellipsoid>>("body", 1000);
    part.mass(5).stiffness({{"a3", stiffness}}).initial_rate({{"a3", 1e-9}}).damping(alpha, beta, drag);
  };
}
/// A ball held at its centre by a spring and damper.
Build ball(double stiffness, double damping) {
  return [=](MultiBody& body) {
    auto& part = body.add<Primitive<Sphere>>("ball", 1000);
    part.mass(2).move({1e-9, 0, 0}, {0, 0, 0});
    body.spring("spring", point(part, 0, 0, 0), world(0, 0, 0), stiffness, damping);
  };
}

}  // namespace

TEST_CASE("N20: the closed form of semi-implicit Euler", "[stable]") {
  // omega^2 h^2 + 2 h (nu + beta omega^2) < 4, with omega^2 = 5 k / m: x'' + (alpha + beta omega^2) x' +
  // omega^2 x = 0.
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

TEST_CASE("N20: RK4 on the imaginary and on the real axis", "[stable]") {
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

TEST_CASE("N20: measured limits are the predicted ones", "[stable]") {
  check_limit("scale", breathing(500, 0, 0));
  check_limit("scale, alpha", breathing(500, 8, 0));
  check_limit("scale, beta", breathing(500, 0, 0.05));
  check_limit("scale, drag", breathing(500, 0, 0.01, 5));
  check_limit("spring", ball(300, 0));
  check_limit("spring and damper", ball(300, 20));
  check_limit("strong damper", ball(300, 400));
}

TEST_CASE("N20: two parts tied by a spring, and coupled parameters", "[stable]") {
  check_limit("two balls", [](MultiBody& body) {
    auto& a = body.add<Primitive<Sphere>>("a", 1000);
    auto& b = body.add<Primitive<Sphere>>("b", 1000);
    a.mass(1).move({1e-9, 0, 0}, {0, 0, 0});
    b.mass(3);
    body.spring("tie", point(a, 0, 0, 0), point(b, 0, 0, 0), 100, 2);
  });
  check_limit("hung at the pole", [](MultiBody& body) {
    auto& a = body.add<Primitive<Ellipsoid>>("a", 1000);
    a.mass(1).stiffness({{"a3", 60}}).move({0, 0, 1e-9}, {0, 0, 0});
    body.spring("string", point(a, material_at(kPi / 2, 0)), world(0, 0, 1), 200, 1);
  });
  check_limit("all parameters", [](MultiBody& body) {
    Part& part = test::add(body, "part", "box", {"taper", "shear"}, 1);
    part.rest({{"a1", 0.3}, {"taper.tx", 0.3}});
    part.stiffness({{"a1", 30}, {"a3", 20}, {"taper.tx", 3}, {"taper.ty", 1}, {"shear.sx", 4}});
    part.initial_rate({{"a1", 1e-9}, {"taper.ty", 1e-9}, {"shear.sx", 1e-9}});
  });
}

TEST_CASE("nothing stiff: any step", "[stable]") {
  MultiBody body;
  body.add<Primitive<Box>>("box", 1000).move({1, 0, 0}, {0, 1, 0});
  CHECK(std::isinf(largest_stable_step(Simulation(body))));
}
