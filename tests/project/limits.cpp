// Limits of parameters as one-sided constraints. A parameter never passes a limit; it can rest at the limit
// and leave the limit again. The ledger records the work of limits.
// N04 and N06 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include "motion.h"
#include "worst.h"

namespace limits_test {

using namespace pliant;

namespace {

const char* const kMethods[] = {"rk4", "semi_implicit_euler"};

/// Advances the simulation by the time `end` (s) and requires after each step that every parameter is exactly
/// within its limits.
void run_within(Simulation& simulation, double end, int steps) {
  for (int i = 0; i < steps; ++i) {
    simulation.step(end / steps);
    for (const PartModel& m : simulation.model().parts())
      for (int k = 0; k < m.n_s; ++k) {
        const Parameter& p = m.part->parameters().moving(k);
        const double q = simulation.state().q[m.q0 + 7 + k];
        INFO(p.name << " at step " << i);
        REQUIRE(p.limits.min <= q);
        REQUIRE(q <= p.limits.max);
      }
  }
}

}  // namespace

TEST_CASE(
    "a parameter that hits its limit at speed stops there, and loses the energy that the ledger records",
    "[limits]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.initial_rate({{"a3", 1.0}}).limits("a3", {0.5, 1.5});
    Simulation simulation(body, method);
    const double start = simulation.ledger().energy();
    run_within(simulation, 1, 130);
    INFO(method);
    CHECK(simulation.state().q[7] == 1.5);
    CHECK(simulation.state().v[6] == 0);
    CHECK(simulation.state().at_limit[0] == 1);
    const Ledger ledger = simulation.ledger();
    CHECK(ledger.energy() == Approx(0).margin(1e-12 * start));
    CHECK(ledger.work[static_cast<int>(Work::limits)] == Approx(-start).epsilon(1e-12));
    CHECK(std::abs(ledger.balance) <= 1e-12 * start);
  }
}

TEST_CASE("a parameter pressed by a force rests at its limit, and leaves it when the force reverses",
          "[limits]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.mass(5).make_dynamic({"a3"}).limits("a3", {0.5, 1.5}).place({0, 0, 0});
    // Forces pull both poles outwards, later inwards.
    const TimeFunction pull = test::wave(0, 20, 2);
    const TimeFunction push = test::wave(0, -20, 2);
    body.force("top", point(part, material_at(kPi / 2, 0)), TimeVector(0, 0, pull));
    body.force("bottom", point(part, material_at(-kPi / 2, 0)), TimeVector(0, 0, push));
    Simulation simulation(body, method);
    run_within(simulation, 1, 1000);
    INFO(method);
    CHECK(simulation.state().q[7] == 1.5);
    CHECK(simulation.state().at_limit[0] == 1);
    // The force changes its sign at pi / 2 s.
    run_within(simulation, kPi / 2 - 1 - 0.01, 500);
    CHECK(simulation.state().q[7] == 1.5);
    CHECK(simulation.state().v[6] == 0);
    run_within(simulation, 0.11, 110);
    CHECK(simulation.state().q[7] < 1.5);
    CHECK(simulation.state().at_limit[0] == 0);
    run_within(simulation, 1.4, 1400);
    CHECK(simulation.state().q[7] == 0.5);
    CHECK(simulation.state().at_limit[0] == -1);
    const Ledger ledger = simulation.ledger();
    const double scale = ledger.work.cwiseAbs().sum();
    INFO(ledger.work.transpose() << " balance " << ledger.balance);
    CHECK(std::abs(ledger.balance) <= (std::string(method) == "rk4" ? 1e-4 : 1e-2) * scale);
  }
}

TEST_CASE("gravity and a spring press the parameter of a hanging part onto its limit", "[limits]") {
  for (const char* method : kMethods) {
    MultiBody body;
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.mass(3).stiffness({{"a3", 400}, {"a1", 800}}).damping(0, 0.02, 1).limits("a3", {0.9, 1.02});
    body.spring("string", point(part, material_at(kPi / 2, 0)), world(0, 0, 1.2), 2000, 60);
    Simulation simulation(body, method);
    run_within(simulation, 12, 12000);
    INFO(method);
    CHECK(simulation.state().q[8] == 1.02);
    CHECK(simulation.state().at_limit[1] == 1);
    CHECK(simulation.state().v.norm() < 1e-4);
    const Ledger ledger = simulation.ledger();
    CHECK(std::abs(ledger.balance) <=
          (std::string(method) == "rk4" ? 1e-5 : 2e-2) * ledger.work.cwiseAbs().sum());
  }
}

TEST_CASE("N04: exponents that are pulled beyond their range stay in the range", "[limits][long]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "superellipsoid", {}, 1000);
    part.make_dynamic({"eps1"}).initial_rate({{"eps1", -8}}).velocity({0, 0, 0}, {0.5, 0, 1});
    Simulation simulation(body, method);
    run_within(simulation, 0.3, 60);
    INFO(method);
    CHECK(simulation.state().q[7] == 0.1);
    CHECK(simulation.ledger().work[static_cast<int>(Work::limits)] < 0);
  }
}

TEST_CASE("N06: an axis pushed through zero stops at its limit, and the part is never turned inside out",
          "[limits]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.make_dynamic({"a1", "a2", "a3"}).damping(0, 0, 0.5).velocity({0, 0, 0}, {0, 0, 1});
    body.force("in", point(part, 0, 0), TimeVector(-3e4, 0, 0), Frame::body);
    body.force("from behind", point(part, 0, kPi), TimeVector(3e4, 0, 0), Frame::body);
    Simulation simulation(body, method);
    run_within(simulation, 1, 2000);
    INFO(method);
    CHECK(simulation.state().q[7] == 1e-3);
  }
}

TEST_CASE("several limits at once, coupled by the mass matrix", "[limits]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "box", {"taper", "shear"}, 1000);
    part.rest({{"a1", 0.3}, {"a2", 0.4}, {"a3", 0.6}, {"taper.tx", 0.2}});
    part.make_dynamic({"a1", "a2", "a3", "taper.tx", "taper.ty", "shear.sx", "shear.sy"});
    part.limits("a1", {0.28, 0.35}).limits("a2", {0.35, 0.41}).limits("a3", {0.55, 0.62});
    part.limits("taper.tx", {0.1, 0.3}).limits("taper.ty", {-0.1, 0.1}).limits("shear.sx", {-0.1, 0.05});
    part.limits("shear.sy", {-0.2, 0.1});
    part.initial_rate({{"a1", 0.4},
                       {"a2", -0.5},
                       {"a3", 0.6},
                       {"taper.tx", -1},
                       {"taper.ty", 2},
                       {"shear.sx", 1},
                       {"shear.sy", -2}});
    part.velocity({0.3, 0, 0}, {2, -1, 3});
    // Two forces act outwards along the line between two opposite points, so that the part stretches and
    // shears, and hardly rotates.
    const Vec3<double> push =
        8000 * part.s({material_at(0.4, 0.5)}, part.parameters().rest()).col(0).normalized();
    body.force("push", point(part, 0.4, 0.5), TimeVector(push), Frame::body);
    body.force("pull", point(part, -0.4, 0.5 - kPi), TimeVector(-push), Frame::body);
    Simulation simulation(body, method);
    const Vec3<double> P = simulation.ledger().momentum;
    run_within(simulation, 1, 2000);
    INFO(method);
    int at = 0;
    for (const std::int8_t limit : simulation.state().at_limit) at += limit != 0 ? 1 : 0;
    CHECK(at >= 3);
    const Ledger ledger = simulation.ledger();
    INFO(ledger.work.transpose() << " balance " << ledger.balance << " P " << P.transpose() << " now "
                                 << ledger.momentum.transpose());
    CHECK(std::abs(ledger.balance) <=
          (std::string(method) == "rk4" ? 1e-9 : 5e-3) * ledger.work.cwiseAbs().sum());
    CHECK(simulation.step_counters().limit_impulses < 400);  // the parameters come to rest at their limits
    // Limits act inside the part, and the two forces cancel, so P is conserved.
    CHECK((ledger.momentum - P).norm() <= (std::string(method) == "rk4" ? 1e-6 : 2e-2) * P.norm());
  }
}

TEST_CASE("a parameter that starts at its limit and moves outwards is stopped in the first step",
          "[limits]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.initial({{"a1", 1.2}}).initial_rate({{"a1", 2}}).limits("a1", {0.5, 1.2});
    Simulation simulation(body, method);
    const double start = simulation.ledger().energy();
    INFO(method);
    REQUIRE(start > 1);
    for (int i = 0; i < 10; ++i) {
      run_within(simulation, 0.01, 1);
      CHECK(simulation.state().q[7] == 1.2);
      CHECK(simulation.state().v[6] == 0);
      CHECK(std::abs(simulation.ledger().balance) <= 1e-12 * start);
    }
    CHECK(simulation.ledger().work[static_cast<int>(Work::limits)] == Approx(-start).epsilon(1e-12));
  }
}

TEST_CASE("limits that a motion does not reach do not change its bits", "[limits]") {
  for (const char* method : kMethods) {
    VecX<double> q[2];
    for (int wide = 0; wide < 2; ++wide) {
      MultiBody body;
      Part& part = test::tumbling_solid(body);
      if (wide == 0) part.limits("a1", {0.1, 0.9}).limits("taper.tx", {-0.8, 0.9});
      Simulation simulation(body, method);
      test::run(simulation, 0.2, 200);
      q[wide] = simulation.state().q;
    }
    CHECK(q[0] == q[1]);
  }
}

TEST_CASE("initial values outside the limits are refused", "[limits]") {
  MultiBody body;
  Part& part = test::add(body, "part", "ellipsoid", {"taper"}, 1000);
  part.initial({{"taper.tx", 1.5}});
  CHECK_THROWS_WITH(Model(body),
                    test::has_text("initial value 1.5 of taper.tx is outside its limits [-1, 1]"));
}

TEST_CASE("limits are checked at the rest value, in either order of the calls", "[limits]") {
  MultiBody body;
  Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
  part.make_dynamic({"a1"}).limits("a1", {0.002, 900}).rest({{"a1", 5}});
  CHECK_THROWS_WITH(Model(body), test::has_text("limits [0.002, 900] of a1 must be within"));
  part.limits("a1", {0.005, 4000});  // valid for this rest value, but not for the default
  CHECK_NOTHROW(Model(body));
}

TEST_CASE("directional derivatives keep parameters at active limits fixed", "[limits]") {
  MultiBody body;
  Part& part = test::add(body, "part", "ellipsoid", {"taper"}, 1000);
  part.rest({{"a1", 0.5}})
      .make_dynamic({"a1", "a3", "taper.tx"})
      .limits("a3", {0.5, 1})
      .velocity({0, 0, 0}, {1, 2, 0.3});
  Simulation simulation(body, "rk4");
  const State& state = simulation.state();
  REQUIRE(state.at_limit[1] == 1);  // spin presses a3 outwards
  Workspace<double> work;
  simulation.dynamics().accelerations(0, state.q, state.v, state, work);
  REQUIRE(work.v_dot[7] == Approx(0).margin(1e-12));
  const VecX<double> dq = VecX<double>::Constant(state.q.size(), 0.01);
  VecX<double> dv = VecX<double>::Constant(state.v.size(), 0.1);
  dv[7] = 0;  // zero, because the parameter is to stay at its limit
  const VecX<double> d = simulation.dynamics().jvp(state, {dq, dv});
  CHECK(std::abs(d[7]) <= 1e-12 * d.norm());
  Workspace<double> more;
  const double e = 1e-6;
  simulation.dynamics().accelerations(0, state.q + e * dq, state.v + e * dv, state, more);
  simulation.dynamics().accelerations(0, state.q - e * dq, state.v - e * dv, state, work);
  CHECK((d - (more.v_dot - work.v_dot) / (2 * e)).norm() <= 1e-6 * d.norm());
}

}  // namespace limits_test
