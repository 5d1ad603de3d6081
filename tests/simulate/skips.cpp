// Quantities that a scene does not need are not computed, as the counters of the kernels show. A step
// allocates no heap memory.
#include "catch.h"

#include <cstdlib>

#include <pliant/body/joints/rod.h>
#include <pliant/part/local/local_laws.h>

#include "motion.h"
#include "spring_net.h"

namespace skips_test {

using namespace pliant;

namespace {
long allocations = 0;
}  // namespace

// Sanitizers replace malloc, so that allocations cannot be counted in builds with sanitizers.
#if defined(__GLIBC__) && !defined(PLIANT_SANITIZED)
constexpr bool kCounted = true;
extern "C" void* __libc_malloc(std::size_t size);
extern "C" void* __libc_calloc(std::size_t n, std::size_t size);
extern "C" void* malloc(std::size_t size) noexcept {
  ++allocations;
  return __libc_malloc(size);
}
// Compilers merge malloc and memset into calloc.
extern "C" void* calloc(std::size_t n, std::size_t size) noexcept {
  ++allocations;
  return __libc_calloc(n, size);
}
#else
constexpr bool kCounted = false;
#endif

namespace {

const char* const kMethods[] = {"rk4", "semi_implicit_euler"};

Counters after_steps(Simulation& simulation, int steps) {
  for (int i = 0; i < steps; ++i) simulation.step(1e-3);
  return simulation.counters();
}

/// Checks that ten steps of h (s) allocate no heap memory, after two steps in which all buffers receive their
/// sizes.
void check_heap(Simulation& simulation, double h) {
  simulation.step(h);
  simulation.step(h);
  const long before = allocations;
  CHECK((before > 0) == kCounted);
  for (int i = 0; i < 10; ++i) simulation.step(h);
  const long allocated = allocations - before;
  CHECK(allocated == 0);
}

}  // namespace

TEST_CASE("all parameters frozen: neither J nor Jdot nor a mass matrix is evaluated", "[skip]") {
  for (const char* method : kMethods) {
    MultiBody body;
    Part& part = test::add(body, "rigid", "superellipsoid", {"taper", "bend"}, 1000);
    part.rest({{"a1", 0.3}, {"bend.angle", 0.3}}).velocity({1, 0, 0}, {1, 2, 3});
    body.spring("spring", point(part, 0.3, 1), world(0, 0, 1), 100);
    Simulation simulation(body, method);
    const Counters counters = after_steps(simulation, 10);
    CHECK(counters.jacobian_points == 0);
    CHECK(counters.rate_points == 0);
    CHECK(counters.mass_matrices == 0);
    CHECK(counters.point_jets == 0);
    CHECK(counters.surfaces == 0);
    CHECK(counters.inertial_forces == simulation.step_counters().evaluations);
    CHECK(simulation.model().n_q() == 7);
  }
}

TEST_CASE("rigid parts on ball joints: only inertial forces are evaluated, once for each part", "[skip]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    for (int i = 0; i < 6; ++i)
      test::add(body, "link" + std::to_string(i), "superellipsoid", {"taper", "bend"}, 1000)
          .place({2.0 * i, 0, 0});
    for (std::size_t i = 0; i < 6; ++i)
      body.ball("joint" + std::to_string(i), i == 0 ? world(-1, 0, 0) : point(*body.parts()[i - 1], 0, 0),
                point(*body.parts()[i], 0, kPi));
    Simulation simulation(body, method);
    REQUIRE(simulation.model().rigid_islands().size() == 1);
    const Counters counters = after_steps(simulation, 10);
    CHECK(counters.jacobian_points == 0);
    CHECK(counters.rate_points == 0);
    CHECK(counters.mass_matrices == 0);
    CHECK(counters.point_jets == 0);
    CHECK(counters.inertial_forces == 6 * simulation.step_counters().evaluations);
  }
}

TEST_CASE("a fixed part has no coordinates and needs no evaluation", "[skip]") {
  MultiBody body;
  test::add(body, "post", "box", {"taper"}, 1000).fix();
  Part& part = test::add(body, "ball", "sphere", {}, 1000);
  body.spring("spring", point(*body.find("post"), 0.3, 1), point(part, 0, 0), 100);
  Simulation simulation(body);
  const Counters counters = after_steps(simulation, 10);
  CHECK(simulation.model().n_q() == 7);
  CHECK(simulation.model().parts()[0].q0 == -1);
  CHECK(counters.mass_matrices == 0);
  CHECK(counters.point_jets == 0);
}

TEST_CASE("at rest neither rates nor inertial forces are evaluated", "[skip]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {"taper"}, 1000);
    part.stiffness({{"a1", 100}, {"taper.tx", 100}});
    Simulation simulation(body, method);
    const Counters counters = after_steps(simulation, 10);
    CHECK(counters.inertial_forces == 0);
    CHECK(counters.rate_points == 0);
    CHECK(counters.mass_matrices == simulation.step_counters().evaluations);
  }
}

TEST_CASE("frozen parameters have no columns, and the quadrature rule fits the dynamic ones", "[skip]") {
  MultiBody body;
  Part& part = test::add(body, "part", "superellipsoid", {"taper", "twist"}, 1000);
  part.make_dynamic({"a1", "twist.angle"});
  Simulation simulation(body);
  CHECK(part.rest_inertia().M.rows() == 8);
  CHECK(simulation.model().n_v() == 8);
  CHECK(part.mass_points().rule == "sections");
  // Semi-axes alone need four mass points.
  MultiBody scales;
  Part& scaled = test::add(scales, "part", "supertoroid", {}, 1000);
  scaled.make_dynamic({"a1", "a2", "a3"});
  const Simulation scales_run(scales);
  CHECK(scaled.mass_points().n_points == 4);
}

TEST_CASE("without output no surface is evaluated; evaluations are counted", "[skip]") {
  MultiBody body;
  test::tumbling_solid(body);
  Simulation rk4(body, "rk4"), euler(body, "semi_implicit_euler");
  CHECK(after_steps(rk4, 10).surfaces == 0);
  after_steps(euler, 10);
  CHECK(rk4.step_counters().evaluations == 40);
  CHECK(euler.step_counters().evaluations == 10);
  CHECK(rk4.step_counters().steps == 10);
  CHECK(rk4.counters().rate_points == 40 * body.parts()[0]->mass_points().n_points);
}

TEST_CASE("a step allocates no heap memory", "[skip]") {
  for (const char* method : kMethods) {
    MultiBody body;
    Part& a = test::tumbling_solid(body, "a");
    a.damping(0.1, 0.001, 0.1).rest("a1", test::wave(0.3, 0.05, 20));
    Part& b = test::add(body, "b", "box", {}, 1000);
    b.place({1, 0, 0}).velocity({0, 0, 0}, {1, 2, 3});
    Part& c = test::add(body, "c", "ellipsoid", {"twist"}, 1000);
    c.elasticity({"neo_hookean", 1e6, 0.3, 0}).damping(0, 1e-4);
    c.initial({{"a1", 1.01}, {"twist.angle", 0.1}});
    body.spring("tie", point(a, 0.3, 1), point(b, 0, 0), 100, 1, 0.3);
    body.force("push", point(a, 0.3, 1), TimeVector(test::wave(0, 1, 3), 0, 0));
    body.torque("turn", b, TimeVector(test::wave(0, 1, 3), 0, 0));
    Simulation simulation(body, method);
    INFO(method);
    check_heap(simulation, 1e-3);
  }
}

TEST_CASE("a step of parts with joints allocates no heap memory", "[skip]") {
  for (const char* method : kMethods) {
    MultiBody body;
    const Part* above = nullptr;
    for (int i = 0; i < 8; ++i) {
      Part& part = test::add(body, "part" + std::to_string(i), "ellipsoid", {}, 1000);
      part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.3}})
          .place({0, 0, -0.6 * i})
          .velocity({0, 0, 0}, {0, 0, 2});
      if (i % 2 == 1) part.stiffness({{"a1", 1e6}, {"a3", 1e6}});
      body.ball("ball" + std::to_string(i), above == nullptr ? world(0, 0, 0.3) : point(*above, -kPi / 2, 0),
                point(part, kPi / 2, 0));
      above = &part;
    }
    body.join("rod", Rod{1}, {point(*above, -kPi / 2, 0), world(1, 0, -4.5)});
    body.force("push", point(*above, 0, 0), TimeVector(0, test::wave(0, 100, 3), 0));
    Simulation simulation(body, method);
    INFO(method);
    check_heap(simulation, 1e-4);
  }
}

TEST_CASE("a step of a part with local deformation allocates no heap memory", "[skip][local]") {
  for (const char* method : kMethods) {
    MultiBody body;
    Part& part = test::add(body, "jelly", "ellipsoid", {}, 1000);
    LocalSettings settings;
    settings.resolution = 2;
    settings.energies = {local_law("elastic", {1e4, 0.3})};
    settings.velocity = test::sample_velocity;
    settings.alpha = 0.1;
    part.velocity({0, 0, 0}, {1, 2, 3}).deform_locally(settings);
    body.spring("tie", point(part, 0.3, 1), world(0, 0, 2), 1, 0.1, 0.3);
    Simulation simulation(body, method);
    INFO(method);
    check_heap(simulation, 1e-4);
  }
}

TEST_CASE("without local deformation there are no nodes; with it, J of frozen parameters is not evaluated",
          "[skip][local]") {
  for (const bool soft : {false, true}) {
    MultiBody body;
    Part& part = test::add(body, "body", "ellipsoid", {}, 1000);
    part.make_shell().velocity({0, 0, 0}, {1, 2, 3});
    LocalSettings settings = test::net(2, 1e3);
    settings.velocity = test::sample_velocity;
    if (soft) part.deform_locally(settings);
    Simulation simulation(body, "rk4");
    const Counters counters = after_steps(simulation, 10);
    CHECK(counters.jacobian_points == 0);  // no parameter is dynamic
    CHECK(counters.rate_points == 0);
    CHECK((simulation.model().parts()[0].local == nullptr) == !soft);
    CHECK((counters.mass_matrices == 0) == !soft);
    CHECK(simulation.state().q.size() == 7 + part.n_d());
  }
}

// The reference conditions W^T d = 0 (include/pliant/part/local/README.md) separate d from other motions.
TEST_CASE("reference conditions that are satisfied need no further evaluation after a step",
          "[skip][local][long]") {
  for (const char* method : {"rk4", "semi_implicit_euler", "linearly_implicit"})
    for (const bool soft : {false, true}) {
      CAPTURE(method, soft);
      MultiBody body;
      Part& part = test::add(body, "jelly", "ellipsoid", {}, 1000);
      if (soft) part.stiffness({{"a1", 1e4}}).initial_rate({{"a1", 0.1}});
      LocalSettings settings;
      settings.resolution = 2;
      settings.energies = {local_law("elastic", {1e4, 0.3})};
      settings.velocity = test::sample_velocity;
      part.velocity({0, 0, 0}, {1, 2, 3}).deform_locally(settings);
      Simulation simulation(body, method);
      const double steps = 1000, masses = static_cast<double>(after_steps(simulation, 1000).mass_matrices),
                   evaluations = static_cast<double>(simulation.step_counters().evaluations);
      if (soft)
        CHECK(masses >= evaluations + steps);  // the reference conditions depend on the parameters
      else
        CHECK(masses <= evaluations + 0.02 * steps);
    }
}

TEST_CASE("a step with a parameter without inertia allocates no heap memory", "[skip]") {
  for (const char* method : kMethods) {
    MultiBody body;
    Part& part = test::add(body, "part", "box", {"bend"}, 1000);
    part.make_dynamic({"bend.direction"})
        .velocity({0, 0, 0}, {1, 2, 3});  // the direction of a zero bend has no effect
    Simulation simulation(body, method);
    INFO(method);
    check_heap(simulation, 1e-3);
    CHECK(simulation.velocities_without_inertia().count("part.bend.direction") == 1);
  }
}

TEST_CASE("a step with a parameter at its limit allocates no heap memory", "[skip]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.make_dynamic({"a1", "a3"}).limits("a1", {0.5, 1}).velocity({0, 0, 0}, {0, 0, 2});
    Simulation simulation(body, method);
    for (int i = 0; i < 5; ++i) simulation.step(1e-3);
    REQUIRE(simulation.state().q[7] == 1);
    INFO(method);
    check_heap(simulation, 1e-3);
  }
}

}  // namespace skips_test
