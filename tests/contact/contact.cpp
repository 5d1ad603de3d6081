// Contact of parts with planes and with each other: closed forms of friction, impacts and rolling, rest, and
// conservation laws of impacts.
// N49 to N58 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>

#include <pliant/body/joints/all_joints.h>
#include <pliant/contact/contact_stepping.h>

#include "draws.h"
#include "motion.h"

namespace contact_test {

using namespace pliant;
using test::Draws;

namespace {

Part& ball(MultiBody& body, const char* name, double r, const Vec3<double>& at) {
  Part& part = body.add(make_part(name, "sphere", {}, 1000));
  return part.rest({{"r", r}}).place(at);
}
Part& box(MultiBody& body, const std::string& name, const Vec3<double>& half, const Vec3<double>& at,
          const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity()) {
  Part& part = body.add(make_part(name, "box", {}, 1000));
  return part.rest({{"a1", half[0]}, {"a2", half[1]}, {"a3", half[2]}}).place(at, R);
}
void floor(MultiBody& body) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
Eigen::Quaterniond tilted(double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vec3<double>::UnitY()));
}
constexpr double kG = 9.81;  // m/s^2

/// A method and the tolerance of its error control. A tolerance of 0 means fixed steps.
struct Method {
  const char* name;
  double tolerance;
};
const std::vector<Method> kMethods{{"rk4", 0},      {"implicit_midpoint", 0}, {"linearly_implicit", 0},
                                   {"esdirk", 0},   {"dormand_prince", 0},    {"dop853", 0},
                                   {"dop853", 1e-8}};

}  // namespace

TEST_CASE(
    "N49: a ball bounces at the times of a geometric series, and is at rest after the end of the series",
    "[contact]") {
  const double first = std::sqrt(2 / kG);
  // Returns the largest error of the height of the ball in a run to the time `until` (s), m. e: coefficient
  // of restitution; h: step, s.
  auto error = [&](const Method& method, double e, double h, double until) {
    MultiBody body;
    body.contact.restitution = e;
    ball(body, "ball", 0.1, {0, 0, 1.1});
    floor(body);
    Simulation simulation(body, method.name, 1, method.tolerance);
    double worst = 0;
    while (simulation.time() < until) {
      simulation.step(h);
      const double t = simulation.time();
      double height = 1 - 0.5 * kG * t * t;
      if (t > first) {
        double v = std::sqrt(2 * kG) * e, since = t - first;
        for (; v > 1e-9 && since > 2 * v / kG; v *= e) since -= 2 * v / kG;
        height = v > 1e-9 ? v * since - 0.5 * kG * since * since : 0;
      }
      worst = std::max(worst, std::abs(simulation.state().q[2] - 0.1 - height));
    }
    if (e < 1 && until > first * (1 + e) / (1 - e)) CHECK(simulation.state().v.norm() < 1e-12);
    if (method.name != std::string("semi_implicit_euler"))
      CHECK(std::abs(simulation.ledger().balance) < 1e-11);
    return worst;
  };
  for (const double e : {1.0, 0.9, 0.5, 0.0}) {
    for (const Method& method : kMethods) {
      CAPTURE(e, method.name, method.tolerance);
      // The run continues after the last of infinitely many bounces.
      CHECK(error(method, e, 2e-3, e < 1 ? first * (1 + e) / (1 - e) + 0.5 : 2.5) < 3e-10);
    }
    // With this method the flight between bounces has an error of first order.
    const Method euler{"semi_implicit_euler", 0};
    const double coarse = error(euler, e, 2e-3, 2.5), fine = error(euler, e, 1e-3, 2.5);
    CAPTURE(e, coarse, fine);
    CHECK(coarse < 40 * 2e-3);
    CHECK(coarse / fine > 1.9);
  }
}

TEST_CASE("N50: a block on a slope stays at rest below the friction angle, and slides by Coulomb's law above",
          "[contact]") {
  const double angle = kPi / 6, limit = std::tan(angle), h = 4e-3;
  std::vector<Method> methods = kMethods;
  methods.push_back({"semi_implicit_euler", 0});
  for (const Method& method : methods)
    for (const double mu : {limit + 1e-6, limit - 1e-6, 0.3, 0.0}) {
      CAPTURE(method.name, method.tolerance, mu);
      MultiBody body;
      body.contact.friction = mu;
      const Eigen::Quaterniond R = tilted(angle);
      const Vec3<double> n = R * Vec3<double>::UnitZ();
      box(body, "block", {0.1, 0.1, 0.1}, 0.1 * n, R);
      body.plane("slope", Vec3<double>(0, 0, 0), n);
      Simulation simulation(body, method.name, 1, method.tolerance);
      test::run(simulation, 1, static_cast<int>(std::lround(1 / h)));
      const double a = kG * std::max(0.0, std::sin(angle) - mu * std::cos(angle)),
                   // With semi-implicit Euler the displacement is a t (t + h) / 2.
          delay = method.name == std::string("semi_implicit_euler") ? h : 0;
      const Vec3<double> displacement = simulation.state().q.head<3>() - 0.1 * n;
      CHECK(displacement.norm() == Approx(0.5 * a * (1 + delay)).epsilon(1e-7).margin(3e-14));
      CHECK(simulation.state().v.head<3>().norm() == Approx(a).epsilon(1e-7).margin(3e-14));
      CHECK(std::abs(displacement.dot(n)) < 3e-14);
    }
}

TEST_CASE("a resting part stays at rest while another part bounces", "[contact]") {
  MultiBody body;
  body.contact.friction = 1;
  body.contact.restitution = 0.8;
  const Eigen::Quaterniond R = tilted(kPi / 6);
  const Vec3<double> n = R * Vec3<double>::UnitZ();
  box(body, "block", {0.1, 0.1, 0.1}, 0.1 * n, R);
  ball(body, "ball", 0.05, Vec3<double>(0, 1, 0) + 0.4 * n);
  body.plane("slope", Vec3<double>(0, 0, 0), n);
  Simulation simulation(body, "rk4");
  test::run(simulation, 1, 500);
  CHECK(simulation.step_counters().impacts > 1);
  CHECK((simulation.state().q.head<3>() - 0.1 * n).norm() < 1e-12);
}

TEST_CASE("a part that rests with a parameter at its limit takes few steps with a tolerance", "[contact]") {
  // The weight is 2.1 times the elastic force at the limit. In a motion without contact the elastic force
  // would move the parameter away from its limit.
  for (const char* method : {"esdirk", "dop853"}) {
    MultiBody body;
    Part& part = test::add(body, "ball", "ellipsoid", {}, 100);
    part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place({0, 0, 0.12});
    part.stiffness({{"a3", 200}}).limits("a3", {0.09, 0.11});
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    Simulation simulation(body, method, 1, 1e-3);
    int steps = 0;
    for (; simulation.time() < 0.5; ++steps) simulation.step_up_to(0.5);
    CAPTURE(method, steps);
    CHECK(steps < 800);
    CHECK(simulation.state().q[2] == Approx(0.09).margin(1e-6));
    CHECK(simulation.state().q[7] == Approx(0.09).margin(1e-6));
    CHECK(simulation.ledger().kinetic < 1e-9);
  }
}

TEST_CASE("works of limits and of contact are each recorded once", "[contact]") {
  std::vector<double> balance;
  for (const double h : {4e-3, 2e-3, 1e-3}) {
    MultiBody body;
    Part& part = body.add(make_part("soft", "ellipsoid", {}, 1000));
    part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place({0, 0, 0.3});
    part.stiffness({{"a3", 3000}}).limits("a3", {0.09, 0.12});
    floor(body);
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.4, static_cast<int>(std::lround(0.4 / h)));
    CHECK(simulation.ledger().work[static_cast<int>(Work::limits)] < 0);
    balance.push_back(std::abs(simulation.ledger().balance));
  }
  CAPTURE(balance[0], balance[1], balance[2]);
  CHECK(test::observed_order(balance) > 1.8);
  CHECK(balance.back() < 2e-4);  // the floor dissipates 8 J
}

TEST_CASE("thin crossed parts do not pass through each other", "[contact]") {
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  body.contact.friction = 0;
  for (const bool second : {false, true}) {
    Part& part = body.add(make_part(second ? "b" : "a", "ellipsoid", {}, 1000));
    part.rest({{"a1", 0.5}, {"a2", 0.01}, {"a3", 0.01}});
    if (second)
      part.place({0.02, 0, 0.1}, Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitZ())))
          .velocity({0, 0, -1}, {0, 0, 0});
  }
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.3, 150);
  CHECK(simulation.state().q[7 + 2] > simulation.state().q[2] + 0.018);  // part a rotates slightly
}

TEST_CASE("a small ball bounces on a huge part as it does on a plane", "[contact]") {
  std::vector<double> heights;
  for (const bool huge : {false, true}) {
    MultiBody body;
    body.contact.restitution = 0.5;
    ball(body, "ball", 0.005, {0, 0, 0.1});
    if (huge)
      box(body, "ground", {500, 500, 500}, {0, 0, -500}).fix();
    else
      floor(body);
    body.contact.active = true;
    Simulation simulation(body, "rk4");
    test::run(simulation, 1, 500);
    heights.push_back(simulation.state().q[2]);
  }
  CHECK(heights[0] == Approx(0.005).margin(1e-10));
  CHECK(heights[1] == Approx(0.005).margin(1e-8));
}

TEST_CASE("an unstable motion fails with contact as it does without", "[contact]") {
  MultiBody body;
  body.contact.active = true;
  Part& a = ball(body, "a", 0.1, {0, 0, 0});
  Part& b = ball(body, "b", 0.1, {0.5, 0, 0});
  body.spring("spring", point(a, 0, 0, 0), point(b, 0, 0, 0), 1e9);
  Simulation simulation(body, "rk4");
  CHECK_THROWS_AS(test::run(simulation, 10, 1000), NumericalFailure);
}

TEST_CASE("a sliding block stops after v^2 / (2 mu g)", "[contact]") {
  std::vector<double> errors;
  for (const double h : {4e-3, 2e-3, 1e-3}) {
    MultiBody body;
    body.contact.friction = 0.4;
    box(body, "block", {0.3, 0.2, 0.1}, {0, 0, 0.1}).velocity({2, 0.5, 0}, {0, 0, 0});
    floor(body);
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.8, static_cast<int>(std::lround(0.8 / h)));
    CHECK(simulation.state().v.norm() < 1e-12);
    errors.push_back(std::abs(simulation.state().q.head<2>().norm() - 4.25 / (2 * 0.4 * kG)));
    CHECK(errors.back() < 0.4 * kG * h * h);  // the error of the step in which the block stops
  }
}

TEST_CASE("a ball slides, then rolls with 5/7 of its speed, a hollow ball with 3/5", "[contact]") {
  for (const bool hollow : {false, true}) {
    MultiBody body;
    body.contact.friction = 0.3;
    Part& part = ball(body, "ball", 0.1, {0, 0, 0.1}).velocity({1, 0, 0}, {0, 0, 0});
    if (hollow) part.make_shell();
    floor(body);
    Simulation simulation(body, "rk4");
    const double at = hollow ? 0.4 / (0.3 * kG) : 2 / (7 * 0.3 * kG);
    test::run(simulation, 0.9 * at, 100);
    CHECK(simulation.state().v[0] == Approx(1 - 0.3 * kG * 0.9 * at).epsilon(1e-8));
    test::run(simulation, 0.5, 250);
    const double v = hollow ? 3.0 / 5 : 5.0 / 7;
    CHECK(simulation.state().v[0] == Approx(v).epsilon(1e-6));
    CHECK(0.1 * simulation.state().v.segment<3>(3).norm() == Approx(v).epsilon(1e-6));
    CHECK(std::abs(simulation.ledger().balance) < 1e-9);
  }
}

TEST_CASE("N51: a stack of five boxes stands without creep", "[contact]") {
  MultiBody body;
  for (int i = 0; i < 5; ++i)
    box(body, "box" + std::to_string(i), {0.1, 0.1, 0.1}, {0.005 * (i % 3), 0, 0.1 + 0.2 * i});
  floor(body);
  Simulation simulation(body, "rk4");
  const VecX<double> start = simulation.state().q;
  for (int i = 0; i < 100; ++i) {
    simulation.step(2e-3);
    REQUIRE((simulation.state().q - start).lpNorm<Eigen::Infinity>() < 1e-11);
  }
  CHECK(simulation.state().v.norm() < 1e-11);
  CHECK(std::abs(simulation.ledger().balance) < 1e-9);
}

TEST_CASE("parts that collide conserve their momenta, and the energy loss follows from the restitution",
          "[contact][long]") {
  Draws draws(5);
  for (const double e : {0.0, 0.6, 1.0}) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    body.contact.restitution = e;
    body.contact.friction = 0;
    ball(body, "a", 0.1, {0, 0, 0}).velocity({2, 0, 0}, {0, 0, 0});
    ball(body, "b", 0.2, {0.6, 0, 0}).velocity({-1, 0, 0}, {0, 0, 0});
    Simulation simulation(body, "rk4");
    const Ledger before = simulation.ledger();
    test::run(simulation, 0.3, 60);
    const Ledger after = simulation.ledger();
    CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
    CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-9 * before.momentum.norm());
    const double m1 = body.parts()[0]->total_mass(), m2 = body.parts()[1]->total_mass();
    const double loss = 0.5 * (1 - e * e) * m1 * m2 / (m1 + m2) * 9;
    CHECK(before.energy() - after.energy() == Approx(loss).epsilon(1e-9).margin(1e-9));
    CHECK(std::abs(after.balance) < 1e-9);
  }
  // A box and an ellipsoid with friction and random spins: the linear momentum is conserved.
  for (int trial = 0; trial < 3; ++trial) {
    const Vec3<double> spin_a = draws.vector(3), spin_b = draws.vector(3);
    std::vector<double> balance;
    for (const int steps : {300, 600, 1200}) {
      MultiBody body;
      body.gravity.setZero();
      body.contact.active = true;
      box(body, "a", {0.1, 0.15, 0.2}, {0, 0, 0}).velocity({2, 0.1, 0}, spin_a);
      Part& b = body.add(make_part("b", "ellipsoid", {}, 500));
      b.rest({{"a1", 0.2}, {"a2", 0.1}, {"a3", 0.15}}).place({0.6, 0.05, 0.03});
      b.stiffness({{"a1", 3000}}).velocity({-1, 0, 0}, spin_b);
      Simulation simulation(body, "rk4");
      const Ledger before = simulation.ledger();
      bool met = false;
      for (int i = 0; i < steps; ++i) {
        simulation.step(0.3 / steps);
        met = met || !simulation.contact()->contacts().empty();
      }
      REQUIRE(met);
      const Ledger after = simulation.ledger();
      CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
      CHECK(after.energy() < before.energy());
      balance.push_back(std::abs(after.balance) / before.kinetic);
      const Model& model = simulation.model();
      CHECK(ContactFinder(model).find(simulation.state(), simulation.time(), -1e-4).empty());
    }
    CAPTURE(trial, balance[0], balance[1], balance[2]);
    CHECK(balance[0] < 2e-3);
    for (const int i : {1, 2}) CHECK(balance[i] < 0.6 * balance[i - 1]);  // of first order
  }
}

TEST_CASE("N53: fast parts do not pass through thin ones", "[contact]") {
  for (const double speed : {1.0, 10.0, 100.0, 1000.0}) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    box(body, "plate", {0.5, 0.5, 0.01}, {0, 0, 0}).fix();
    ball(body, "ball", 0.05, {0.02, 0.03, 0.3}).velocity({0, 0, -speed}, {0, 0, 0});
    Simulation simulation(body, "rk4");
    test::run(simulation, 1 / speed, 10);
    CHECK(simulation.state().q[2] > 0.05);
    CHECK(simulation.state().q[2] == Approx(0.06).margin(1e-9));
  }
}

TEST_CASE("N54: overlapping parts, concentric ones included, are separated with a bounded speed",
          "[contact]") {
  for (const double distance : {0.15, 0.09, 0.02, 0.0}) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    ball(body, "a", 0.1, {0, 0, 0});
    ball(body, "b", 0.1, {distance, 0, 0});
    Simulation simulation(body, "rk4");
    for (int i = 0; i < 200; ++i) {
      const VecX<double> before = simulation.state().q;
      simulation.step(1e-2);
      REQUIRE(simulation.state().q.allFinite());
      CHECK((simulation.state().q - before).lpNorm<Eigen::Infinity>() <= 1.01e-3);
    }
    const Vec3<double> between = simulation.state().q.segment<3>(7) - simulation.state().q.head<3>();
    CHECK(between.norm() >= 0.2 - 1e-9);
    CHECK(simulation.ledger().kinetic == 0);  // the separation adds no velocity
  }
}

TEST_CASE("a jointed part lands, and its joint stays closed during the impact", "[contact]") {
  MultiBody body;
  Part& a = body.add(make_part("a", "ellipsoid", {}, 1000));
  a.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.3}}).place({0, 0, 0.8}, tilted(0.4));
  Part& b = body.add(make_part("b", "ellipsoid", {}, 1000));
  const Vec3<double> top = Vec3<double>(0, 0, 0.8) + tilted(0.4) * Vec3<double>(0, 0, 0.3);
  b.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.3}})
      .place(top - tilted(-0.9) * Vec3<double>(0, 0, -0.3), tilted(-0.9));
  body.ball("joint", point(a, kPi / 2, 0), point(b, -kPi / 2, 0));
  floor(body);
  Simulation simulation(body, "rk4");
  bool met = false;
  for (int i = 0; i < 400; ++i) {
    simulation.step(2e-3);
    met = met || !simulation.contact()->contacts().empty();
    REQUIRE(simulation.model().gap(simulation.state(), 0) < 1e-10);
    REQUIRE(simulation.step_counters().contact_residual < 1e-9);
    for (const Contact& contact :
         ContactFinder(simulation.model()).find(simulation.state(), simulation.time(), 0))
      REQUIRE(contact.gap > -1e-4);
  }
  CHECK(met);
  CHECK(simulation.ledger().work[static_cast<int>(Work::contact)] < 0);
}

TEST_CASE("N58: a plane that appears or moves pushes the parts in its way", "[contact]") {
  MultiBody body;
  body.gravity.setZero();
  ball(body, "ball", 0.1, {0, 0, 0.05});
  ContactPlane& plane = body.plane("hand", TimeVector(0, 0, test::wave(0, 0.2, 3)), {0, 0, 1});
  plane.on = 0.1;
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.1, 10);
  CHECK(simulation.state().q[2] == 0.05);
  double fastest = 0;
  for (int i = 0; i < 100; ++i) {
    simulation.step(1e-2);
    fastest = std::max(fastest, simulation.state().v[2]);
    REQUIRE(simulation.state().v.head<3>().norm() < 1);
  }
  CHECK(fastest > 0.5);
  CHECK(fastest < 0.6 * std::cos(0.3));  // the speed of the plane when it appears
  CHECK(std::abs(simulation.ledger().balance) < 1e-6);
}

TEST_CASE("N58: a plane that hits jointed parts, or appears inside them: their joint stays closed",
          "[contact][joints]") {
  const bool moved = GENERATE(true, false);
  INFO((moved ? "the plane moves" : "the plane appears"));
  MultiBody body;
  body.gravity.setZero();
  Part& a = test::add(body, "a", "box", {}, 800);
  a.rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.05}});
  Part& b = test::add(body, "b", "box", {}, 500);
  b.rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.05}}).place({0.6, 0, 0});
  body.ball("joint", point(a, 0, 0), point(b, 0, kPi));
  // The plane becomes active at 0.05 s. If it moves, it is then below the parts and rises at 2 m/s; otherwise
  // it is inside them.
  ContactPlane& plane =
      moved ? body.plane("hand", TimeVector(0, 0, TimeFunction::formula("2 * t - 0.3")), {0.1, 0, 1})
            : body.plane("hand", TimeVector(0, 0, -0.02), {0.1, 0, 1});
  plane.on = 0.05;
  Simulation simulation(body, "rk4");
  double fastest = 0;
  for (int i = 0; i < 500; ++i) {
    simulation.step(1e-3);
    const State& state = simulation.state();
    fastest = std::max({fastest, state.v.segment<3>(0).norm(), state.v.segment<3>(6).norm()});
    REQUIRE(simulation.model().gap(state, 0) <= 1e-6 * 0.6);
  }
  const Ledger ledger = simulation.ledger();
  CHECK(std::abs(ledger.balance) <= 1e-6 * std::max(1.0, ledger.kinetic));
  CHECK(fastest < (moved ? 5 : 2));
  if (moved)
    CHECK(ledger.momentum[2] > 0.5 * 2 * (a.total_mass() + b.total_mass()));
  else
    CHECK(simulation.state().q[2] > 0.01);  // lifted with a bounded speed
}

TEST_CASE("in free flight contact costs no evaluations, and a resumed run gives identical bits",
          "[contact]") {
  MultiBody body;
  body.contact.restitution = 0.5;
  ball(body, "ball", 0.1, {0, 0, 2});
  floor(body);
  MultiBody free;
  ball(free, "ball", 0.1, {0, 0, 2});
  Simulation one(body, "rk4"), other(free, "rk4");
  test::run(one, 0.2, 50);
  test::run(other, 0.2, 50);
  CHECK(one.state().q == other.state().q);  // in flight, contact does not change a step
  CHECK(one.step_counters().evaluations == other.step_counters().evaluations);
  test::run(one, 0.6, 60);
  const State copy = one.state();
  test::run(one, 0.5, 50);
  const std::uint64_t end = hash(one.state());
  MultiBody again;
  again.contact.restitution = 0.5;
  ball(again, "ball", 0.1, {0, 0, 2});
  floor(again);
  Simulation resumed(again, "rk4");
  resumed.set_state(copy);
  test::run(resumed, 0.5, 50);
  CHECK(hash(resumed.state()) == end);
}

TEST_CASE("invalid contact settings are refused by name", "[contact]") {
  MultiBody body;
  ball(body, "ball", 0.1, {0, 0, 1});
  CHECK_THROWS_WITH(body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 0}),
                    test::has_text("its normal needs a finite length"));
  floor(body);
  CHECK_THROWS_WITH(body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1}),
                    test::has_text("there are two planes called 'floor'"));
  body.contact.pairs.push_back({"ball", "celing"});
  CHECK_THROWS_WITH(Simulation(body, "rk4"), test::has_text("celing"));
  body.contact.pairs.back() = {"ball", "floor", true, -1, 0};
  CHECK_THROWS_WITH(Simulation(body, "rk4"), test::has_text("friction"));
  body.contact.pairs.back() = {"ball", "ball"};
  CHECK_THROWS_WITH(Simulation(body, "rk4"), test::has_text("names 'ball' twice"));
  body.contact.pairs.clear();
  body.contact.groups = {{"round", {"ball", "egg"}}};
  CHECK_THROWS_WITH(Simulation(body, "rk4"), test::has_text("egg"));
  body.contact.groups = {{"floor", {"ball"}}};
  CHECK_THROWS_WITH(Simulation(body, "rk4"), test::has_text("'floor'"));
  body.contact.groups = {{"round", {"ball"}}, {"all", {"round", "floor"}}};
  CHECK_THROWS_WITH(Simulation(body, "rk4"),
                    test::has_text("expected parts, planes and obstacles as members"));
}

TEST_CASE("the most specific rule for a pair applies, and of equally specific rules the last one",
          "[contact]") {
  MultiBody body;
  body.contact.friction = 0.1;
  body.contact.restitution = 0.2;
  for (const char* name : {"a", "b", "c", "d"}) ball(body, name, 0.1, {0, 0, 1});
  floor(body);
  body.contact.groups = {{"pair", {"a", "b"}}, {"most", {"a", "b", "c"}}, {"world", {"floor"}}};
  body.contact.pairs = {{"a", "b", true, 0.9, {}},     {"most", "most", false, {}, {}},
                        {"c", "pair", true, {}, 0.7},  {"pair", "pair", true, 0.3, {}},
                        {"pair", "world", true, 0, 1}, {"floor", "b", true, 0.6, {}},
                        {"b", "floor", false, {}, {}}};
  body.ball("tie", point(*body.find("c"), 0, 0), point(*body.find("d"), 0, 0));
  body.ball("bond", point(*body.find("b"), 0, 0), point(*body.find("c"), 0, 0));
  const Model model(body);
  const ContactRules rules(model);
  auto is = [](const ContactRule& rule, bool touch, double friction, double restitution) {
    CHECK(rule.touch == touch);
    CHECK(rule.friction == friction);
    CHECK(rule.restitution == restitution);
  };
  is(rules.of_parts(0, 1), true, 0.9, 0.2);   // a pair of parts takes precedence over pairs of groups
  is(rules.of_parts(2, 0), true, 0.1, 0.7);   // a part and a group take precedence over two groups
  is(rules.of_parts(1, 2), false, 0.1, 0.7);  // a joint connects b and c, and no pair rule names both
  is(rules.of_parts(2, 3), false, 0.1, 0.2);
  is(rules.of_parts(0, 3), true, 0.1, 0.2);
  is(rules.on_plane(0, 0), true, 0, 1);
  is(rules.on_plane(1, 0), false, 0.1, 0.2);  // the last of two rules
  is(rules.on_plane(3, 0), true, 0.1, 0.2);
}

TEST_CASE("a pair rule without friction uses the general friction", "[contact]") {
  MultiBody body;
  body.contact.friction = 0.4;
  ball(body, "ball", 0.1, {0, 0, 0.1}).velocity({1, 0, 0}, {0, 0, 0});
  floor(body);
  body.contact.pairs = {{"ball", "floor"}};
  Simulation simulation(body, "rk4");
  test::run(simulation, 1, 500);
  CHECK(simulation.state().v[0] == Approx(5.0 / 7));
}

TEST_CASE("reported contacts are those of a whole step, even if the step is divided", "[contact]") {
  MultiBody body;
  Part& lies = box(body, "box", {0.1, 0.1, 0.1}, {0, 0, 0.1});
  ball(body, "falls", 0.05, {1, 0, 0.05 + 0.5 * kG * 0.0101 * 0.0101});
  Part& hangs = ball(body, "hangs", 0.05, {2, 0, 1});
  body.ball("hook", point(hangs, kPi / 2, 0), world(2, 0, 1.05)).during(0.0137, 1);
  floor(body);
  Simulation simulation(body, "rk4");
  simulation.step(0.02);  // the ball lands in this step, and the joint switches
  CHECK(simulation.step_counters().impacts == 1);
  Vec3<double> sum = Vec3<double>::Zero();
  for (std::size_t k = 0; k < simulation.contact()->contacts().size(); ++k)
    if (simulation.contact()->contacts()[k].a.part == 0) sum += simulation.contact()->impulses()[k];
  CHECK(sum[2] == Approx(lies.total_mass() * kG * 0.02).epsilon(1e-9));
  CHECK_THROWS(simulation.step(-1));
  CHECK(!simulation.contact()->contacts().empty());
  simulation.set_state(simulation.state());
  CHECK(simulation.contact()->contacts().empty());
}

TEST_CASE("the impulse on a joint in an impact equals the change of momentum of its part", "[contact]") {
  MultiBody body;
  body.gravity.setZero();
  Part& left = ball(body, "left", 0.1, {0, 0, 0.2}).velocity({0, 0, -2}, {0, 0, 0});
  Part& right = ball(body, "right", 0.05, {0.15, 0, 0.2}).velocity({0, 0, -2}, {0, 0, 0});
  body.weld("rod", point(right, 0, kPi), point(left, 0, 0));
  floor(body);
  Simulation simulation(body, "rk4");
  const ContactRecord& record = simulation.contact()->record();
  for (int i = 0; i < 100 && record.contacts.empty(); ++i) {
    CHECK(record.joint_impulses.isZero(0));
    simulation.step(1e-3);
  }
  REQUIRE(record.contacts.size() == 1);
  Workspace<double> work;
  const State& state = simulation.state();
  const Dynamics& dynamics = simulation.dynamics();
  dynamics.evaluate_joints(state.time(), state.q, state.v, state.joints, simulation.model().islands()[0],
                           work);
  const Vec3<double> impulse = dynamics.joint_wrench(state.time(), 0, work, record.joint_impulses).force;
  const Vec3<double> gain = right.total_mass() * (state.v.segment<3>(6) - Vec3<double>(0, 0, -2));
  // In the rest of the step after the impact, the joint changes the direction of the motion.
  CHECK((impulse - gain).norm() < 0.02 * gain.norm());
  CHECK(impulse[2] > right.total_mass());
  CHECK(record.impulses[0][2] ==
        Approx(simulation.ledger().momentum[2] + 2 * (left.total_mass() + right.total_mass())));
}

TEST_CASE("a ball that rolls on a box does not penetrate it", "[contact]") {
  for (const bool ball_first : {false, true}) {
    MultiBody body;
    body.contact.active = true;
    auto add_ball = [&] { ball(body, "ball", 0.1, {-0.5, 0, 0.1}).velocity({0.5, 0, 0}, {0, 5, 0}); };
    if (ball_first) add_ball();
    box(body, "table", {1, 1, 0.05}, {0, 0, -0.05}).fix();
    if (!ball_first) add_ball();
    Simulation simulation(body, "rk4");
    for (int i = 0; i < 250; ++i) {
      simulation.step(4e-3);
      REQUIRE(std::abs(simulation.state().q[2] - 0.1) < 1e-9);
    }
    CHECK(simulation.state().q[0] == Approx(0).margin(1e-12));
  }
}

}  // namespace contact_test
