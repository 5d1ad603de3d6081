// Extreme models and runs: slender bodies, long runs, decreasing steps, floating-point exceptions.
// N07, N29, N31 and N70 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <cfenv>
#include <chrono>
#include <cmath>

#include <pliant/math/eigenvalues.h>

#include "motion.h"
#include "worst.h"

namespace extremes_test {

using namespace pliant;

TEST_CASE("N07: semi-axes that differ by a factor of a million have accurate accelerations", "[extremes]") {
  // In a free spin about z, a1 and a2 have the accelerations a_i omega^2, for any values of the other axes.
  for (const Vec3<double>& axes :
       {Vec3<double>(1, 1e-6, 1e-6), Vec3<double>(1e6, 1, 1), Vec3<double>(1e-6, 1, 1e6)}) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.rest({{"a1", axes[0]}, {"a2", axes[1]}, {"a3", axes[2]}})
        .make_dynamic({"a1", "a2", "a3"})
        .velocity({0, 0, 0}, {0, 0, 3});
    const Simulation simulation(body, "rk4");
    Workspace<double> work;
    const State& state = simulation.state();
    simulation.dynamics().accelerations(0, state.q, state.v, state, work);
    CHECK(work.v_dot[6] == Approx(9 * axes[0]).epsilon(1e-10));
    CHECK(work.v_dot[7] == Approx(9 * axes[1]).epsilon(1e-10));
    CHECK(std::abs(work.v_dot[8]) <= 1e-10 * 9 * axes[2]);
    CHECK(work.v_dot.head<6>().norm() <= 1e-10);
    // After scaling to a unit diagonal M is as well conditioned as the matrix of a sphere.
    const MatX<double> M = work.parts[0].M();
    const VecX<double> scale = M.diagonal().cwiseSqrt().cwiseInverse();
    const MatX<double> scaled = scale.asDiagonal() * M * scale.asDiagonal();
    CHECK(symmetric_eigenvalues(scaled).minCoeff() > 0.1);
  }
}

TEST_CASE(
    "N29: a step of a damped body at rest takes less than three times as long as a step of a moving one",
    "[extremes]") {
  MultiBody body;
  body.gravity.setZero();
  Part& part = test::add(body, "part", "ellipsoid", {"taper"}, 1000);
  part.stiffness({{"a1", 4000}, {"taper.tx", 300}})
      .initial({{"a1", 1.2}, {"taper.tx", 0.2}})
      .damping(3, 0.01, 0.5);
  part.velocity({0, 0, 0}, {0.1, 0.2, 0});
  test::add(body, "rigid", "sphere", {}, 1000).velocity({1, 2, 3}, {1, 0, 0}).damping(0, 0, 0.5);
  Simulation simulation(body, "semi_implicit_euler");
  auto seconds = [&] {
    double min_seconds = 1e300;
    for (int repeat = 0; repeat < 5; ++repeat) {
      const auto start = std::chrono::steady_clock::now();
      for (int i = 0; i < 4000; ++i) simulation.step(0.01);
      min_seconds = std::min(min_seconds,
                             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    return min_seconds;
  };
  const double moving = seconds();
  for (int i = 0; i < 200000; ++i) simulation.step(0.01);  // amplitudes pass through the subnormal numbers
  const double at_rest = seconds();
  CHECK(simulation.state().v.head<8>().norm() < 1e-12);
  CHECK(simulation.state().v.tail<6>().cwiseAbs().maxCoeff() < 1e-300);
  CHECK(at_rest < 3 * moving);  // operations on subnormal numbers can be tens of times slower
}

TEST_CASE("N31: semi-implicit Euler converges with order 1 to the solution to which rk4 has converged",
          "[extremes][long]") {
  auto run = [](const char* method, int steps) {
    MultiBody body;
    Part& part = test::tumbling_solid(body);
    body.spring("hold", point(part, 0.5, 1), world(0.2, 0, 0.5), 500, 5, 0.1);
    Simulation simulation(body, method);
    test::run(simulation, 0.2, steps);
    return VecX<double>(simulation.state().q);
  };
  const VecX<double> exact = run("rk4", 800);
  CHECK((run("rk4", 400) - exact).norm() <= 1e-9 * exact.norm());
  std::vector<double> errors;
  for (const int steps : {400, 800, 1600, 3200})
    errors.push_back((run("semi_implicit_euler", steps) - exact).norm());
  CHECK(test::observed_order(errors) == Approx(1).margin(0.1));
  CHECK(errors.back() <= 1e-3 * exact.norm());
}

#if defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
TEST_CASE("N70: no operation of a run is invalid, divides by zero or overflows", "[extremes]") {
  // Parts of every shape with every deformation, with loads at their special points.
  for (const auto& face : all_shapes()) {
    MultiBody body;
    Part& part =
        test::add(body, "part", face->name(), {"taper", "twist", "shear", "bend_offset", "bend"}, 1000);
    if (face->mesh() == MeshPattern::torus) part.rest({{"a3", 1}});
    part.make_dynamic({"taper.tx", "twist.angle", "shear.sx", "bend.angle", "bend_offset.b1"});
    part.velocity({0, 0, 1}, {0.3, 0.2, 1}).damping(0.1, 0.001, 0.1);
    body.spring("slack", point(part, kPi / 2, 0), world(0, 0, 1), 100, 1, 0.5);
    body.spring("zero", point(part, 0, 0, 0), world(0, 0, 0), 100, 1);
    body.force("push", point(part, 0, 0), TimeVector(1, 2, 3), Frame::body);
    Simulation simulation(body, "rk4");
    INFO(face->name());
    std::feclearexcept(FE_ALL_EXCEPT);
    for (int i = 0; i < 20; ++i) simulation.step(1e-3);
    CHECK(std::fetestexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW) == 0);
  }
}
#endif

}  // namespace extremes_test
