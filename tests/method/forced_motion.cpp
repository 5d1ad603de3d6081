// The energy ledger of forced motion: each source of work alone, and most of them together. The balance error
// falls at the order of the method.
// N32 and N33 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <functional>

#include "motion.h"

namespace forced_motion_test {

using namespace pliant;

namespace {

using Build = std::function<void(MultiBody&, Part&, Part&)>;

struct Result {
  State state;
  Ledger ledger;
};
/// Returns the state and the ledger of two deforming parts after 0.25 s in `steps` steps. build: adds the
/// loads.
Result end_of(const char* method, int steps, const Build& build) {
  MultiBody body;
  Part& a = test::tumbling_solid(body, "a");
  Part& b = test::add(body, "b", "superellipsoid", {"taper"}, 500);
  b.rest({{"a1", 0.3}, {"a2", 0.3}, {"a3", 0.4}, {"eps1", 0.5}})
      .stiffness({{"a1", 2e4}, {"a3", 2e4}, {"taper.tx", 400}});
  b.place({1.5, 0.3, 0.2}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.6)).velocity({0, 0.4, 0}, {-1, 0.5, 2});
  build(body, a, b);
  Simulation simulation(body, method);
  test::run(simulation, 0.25, steps);
  return {simulation.state(), simulation.ledger()};
}
/// Returns the difference of two states: of coordinates, velocities and works.
double distance(const State& a, const State& b) {
  return (a.q - b.q).norm() + (a.v - b.v).norm() + (a.work - b.work).norm();
}

/// Checks that coordinates, velocities and all works of the ledger converge at the order of the method, and
/// that the ledger balances.
void check_orders(const std::string& what, const Build& build) {
  const Result reference = end_of("rk4", 3200, build);
  const double energy = std::abs(reference.ledger.kinetic) + reference.ledger.work.cwiseAbs().sum();
  INFO(what << ": balance " << reference.ledger.balance << " of " << energy << ", works "
            << reference.ledger.work.transpose());
  CHECK(std::abs(reference.ledger.balance) <= 1e-10 * energy);
  std::vector<double> rk4, euler;
  for (int steps : {200, 400, 800})
    rk4.push_back(distance(end_of("rk4", steps, build).state, reference.state));
  CHECK(test::observed_order(rk4) >= 3.9);
  std::vector<double> balances;
  for (int steps : {1000, 2000}) {
    const Result end = end_of("semi_implicit_euler", steps, build);
    euler.push_back(distance(end.state, reference.state));
    balances.push_back(std::abs(end.ledger.balance));
  }
  CHECK(test::observed_order(euler) >= 0.9);
  CHECK(test::observed_order(balances) >= 0.9);
}

}  // namespace

TEST_CASE("N33: the ledger with gravity", "[forced][long]") {
  check_orders("gravity", [](MultiBody& body, Part&, Part&) { body.gravity = {1, -2, -9.81}; });
}
TEST_CASE("N33: the ledger with springs of zero rest length, with damping, between parts and to the world",
          "[forced][long]") {
  check_orders("springs", [](MultiBody& body, Part& a, Part& b) {
    body.spring("tie", point(a, 0.5, 0.3), point(b, -0.4, 1, 0.7), 800, 30);
    body.spring("link", point(a, -0.2, 2), world(0.3, 1, 0), 500, 20);
  });
}
TEST_CASE("N33: the ledger with springs that have a rest length, with damping", "[forced][long]") {
  check_orders("springs", [](MultiBody& body, Part& a, Part& b) {
    body.spring("tie", point(a, 0.5, 0.3), point(b, -0.4, 1, 0.7), 800, 30, 0.5);
    body.spring("link", world(0.3, 1, 0), point(a, -0.2, 2), 500, 20, 0.4);
  });
}
TEST_CASE("N33: the ledger with moving anchors of both kinds of spring", "[forced][long]") {
  check_orders("anchors", [](MultiBody& body, Part& a, Part& b) {
    body.spring("hand", world({test::wave(0.5, 0.3, 4), 0.2, test::wave(0.1, 0.2, 3, 1)}), point(b, 1.2, -2),
                600, 10, 0.3);
    body.spring("other", point(a, 0.3, 1), world({0, test::wave(1, 0.5, 6), 0.4}), 300, 10);
  });
}
TEST_CASE("N33: the ledger with actuation, a time-dependent rest value", "[forced][long]") {
  check_orders("actuation", [](MultiBody&, Part& a, Part& b) {
    a.rest("twist.angle", test::wave(0.3, 0.4, 9));
    b.rest("a1", test::wave(0.3, 0.05, 7, 1));
  });
}
TEST_CASE("N33: the ledger with mass- and stiffness-proportional damping", "[forced][long]") {
  check_orders("damping", [](MultiBody&, Part& a, Part& b) {
    a.damping(0.8, 0.004);
    b.damping(0.5, 0.002);
  });
}
TEST_CASE("N33: the ledger with drag", "[forced][long]") {
  check_orders("drag", [](MultiBody&, Part& a, Part& b) {
    a.damping(0, 0, 0.7);
    b.damping(0, 0, 0.3);
  });
}
TEST_CASE("N33: the ledger with point forces and torques in both frames, and a user-defined force",
          "[forced][long]") {
  check_orders("forces", [](MultiBody& body, Part& a, Part& b) {
    body.force("push", point(b, 0.3, 0.3), TimeVector(test::wave(10, 20, 6), 5, 0));
    body.force("jet", point(a, -0.7, 1), TimeVector(3, test::wave(0, 30, 5), 8), Frame::body);
    body.force("own", point(a, 0.9, -1), [](double t, const Vec3<double>& x, const Vec3<double>& v) {
      return Vec3<double>(20 * std::sin(3 * t) - x[0], -4 * v[1], 2 * x[2]);
    });
    body.torque("turn", b, TimeVector(1, test::wave(2, 3, 4), 0));
    body.torque("spin", a, TimeVector(0, 2, test::wave(0, 4, 5)), Frame::body);
  });
}
TEST_CASE("N33: the ledger with most kinds of load at once", "[forced][long]") {
  check_orders("all", [](MultiBody& body, Part& a, Part& b) {
    body.gravity = {0.5, 0, -9.81};
    a.damping(0.3, 0.002, 0.2).rest("bend.angle", test::wave(0.4, 0.2, 5));
    Part& post = test::add(body, "post", "cylinder", {}, 1000);
    post.place({-1, 0, 0}).fix();
    body.spring("tie", point(a, 0.5, 0.3), point(b, -0.4, 1, 0.7), 800, 12, 0.6);
    body.spring("link", point(a, -0.2, 2), point(post, 0, 0), 500, 5);
    body.spring("hand", world({test::wave(0.5, 0.3, 4), 0.2, 0.1}), point(b, 1.2, -2), 600, 8, 0.3);
    body.force("push", point(b, 0.3, 0.3), TimeVector(test::wave(10, 20, 6), 5, 0));
    body.torque("turn", b, TimeVector(1, test::wave(2, 3, 4), 0));
  });
}

TEST_CASE("N32: damping and drag only remove energy", "[forced]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {"twist"}, 1000);
    part.rest({{"a1", 0.4}}).stiffness({{"twist.angle", 2000}, {"a1", 2e5}}).damping(5, 0.01, 1);
    part.initial({{"twist.angle", 0.5}, {"a1", 0.45}}).velocity({1, 0, 0}, {0, 0, 2});
    Simulation simulation(body, method);
    const double start = simulation.ledger().energy();
    double before = start;
    for (int i = 0; i < 2000; ++i) {
      simulation.step(5e-4);
      const Ledger now = simulation.ledger();
      if (std::string(method) == "rk4") REQUIRE(now.energy() <= before + 1e-12 * start);
      REQUIRE(now.work[static_cast<int>(Work::damping)] <= 0);
      REQUIRE(now.work[static_cast<int>(Work::drag)] <= 0);
      before = now.energy();
    }
    CHECK(before < 0.5 * start);
  }
}

TEST_CASE("a part under drag alone slows down as exp(-nu t), its parameter rates too", "[forced]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Sphere>>("ball", 1000);
  part.damping(0, 0, 0.8).make_dynamic({"r"}).initial_rate({{"r", 0.1}}).velocity({2, 0, 0}, {0, 0, 0});
  Simulation simulation(body, "rk4");
  test::run(simulation, 1, 200);
  CHECK(simulation.state().v[0] == Approx(2 * std::exp(-0.8)).epsilon(1e-10));
  CHECK(simulation.state().v[6] == Approx(0.1 * std::exp(-0.8)).epsilon(1e-10));
}

TEST_CASE("a damped spring follows the closed form", "[forced]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Sphere>>("ball", 1000);
  part.mass(2).place({0.3, 0, 0});
  body.spring("spring", point(part, 0, 0, 0), world(0, 0, 0), 50, 4);
  Simulation simulation(body, "rk4");
  test::run(simulation, 1, 1000);
  const double decay = 1, omega = std::sqrt(25.0 - 1);
  const double x = 0.3 * std::exp(-decay) * (std::cos(omega) + decay / omega * std::sin(omega));
  CHECK(simulation.state().q[0] == Approx(x).epsilon(1e-9));
}

TEST_CASE("a hanging elastic body stretches under its weight: static equilibrium", "[forced]") {
  // A spring at the centre of the ellipsoid would not stretch it, because gravity has no generalized force on
  // a3.
  MultiBody body;
  auto& part = body.add<Primitive<Ellipsoid>>("body", 1000);
  part.mass(3).stiffness({{"a3", 400}}).damping(0, 0.02);
  // The string, a stiff damped spring, pulls at the pole with the weight: a3 grows by m g / k3.
  body.spring("string", point(part, material_at(kPi / 2, 0)), world(0, 0, 3), 2000, 60);
  Simulation simulation(body, "rk4");
  test::run(simulation, 20, 20000);
  const double weight = 3 * 9.81;
  CHECK(simulation.state().q[7] - 1 == Approx(weight / 400).epsilon(1e-6));
  CHECK(simulation.state().q[2] + simulation.state().q[7] == Approx(3 - weight / 2000).epsilon(1e-6));
}

}  // namespace forced_motion_test
