// What contact does to energy and momentum: inelastic, frictional motion never gains, a blow on a springboard
// is that of the closed form, and a joint that pulls through a floor says so.
#include "catch.h"

#include <cmath>
#include <functional>

#include <pliant/body/joints/all_joints.h>

#include "motion.h"

namespace contact_balance_test {

using namespace pliant;

namespace {

using Build = std::function<void(MultiBody&)>;

void floor(MultiBody& body) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
void tumbling_box(MultiBody& body) {
  Part& part = body.add(make_part("box", "box", {}, 1000));
  part.rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}});
  part.place({0, 0, 0.6}, Eigen::Quaterniond(0.8, 0.1, -0.5, 0.2).normalized());
  part.move({1, 0.3, 0}, {3, -2, 5});
  floor(body);
}
void pile(MultiBody& body) {
  for (int i = 0; i < 6; ++i)
    body.add(make_part("part" + std::to_string(i), "ellipsoid", {}, 1000))
        .rest({{"a1", 0.1}, {"a2", 0.08}, {"a3", 0.06}})
        .place({0.03 * (i % 2), 0.02 * (i % 3), 0.15 + 0.25 * i},
               Eigen::Quaterniond(Eigen::AngleAxisd(i, Vec3<double>(1, 2, 3).normalized())));
  floor(body);
}
void chain(MultiBody& body) {
  Part* last = nullptr;
  for (int i = 0; i < 4; ++i) {
    Part& part = body.add(make_part("part" + std::to_string(i), "ellipsoid", {}, 1000));
    part.rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.15}});
    part.place({0.3 * i, 0, 0.5}, Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitY())));
    if (last != nullptr)
      body.ball("joint" + std::to_string(i), point(*last, kPi / 2, 0), point(part, -kPi / 2, 0));
    last = &part;
  }
  floor(body);
}

}  // namespace

TEST_CASE("inelastic contact with friction gains no energy beyond the error of a step", "[contact]") {
  for (const Build& build : std::vector<Build>{tumbling_box, pile, chain})
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      MultiBody one, other;
      build(one);
      build(other);
      Simulation whole(one, method), halves(other, method);
      const double h = 1e-3, start = whole.ledger().energy();
      for (int i = 0; i < 700; ++i) {
        const double before = whole.ledger().energy();
        halves.set_state(whole.state());
        whole.step(h);
        halves.step(h / 2);
        halves.step(h / 2);
        const double after = whole.ledger().energy();
        // Errors of second order in a step: two halves err by half as much. That is to leading order.
        const double error = 2 * std::abs(after - halves.ledger().energy());
        CAPTURE(method, i);
        REQUIRE(after - before <= 2 * error + 1e-6 * h * start);
      }
      CHECK(whole.ledger().energy() < 0.95 * start);
    }
}

TEST_CASE("N59: the blow of a ball on a springboard is that of the closed form", "[contact][joints]") {
  const double radius = 0.05, x = 0.6, speed = 3;
  for (const double e : {0.0, 0.5, 1.0}) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    body.contact.friction = 0;
    body.contact.restitution = e;
    Part& board = body.add(make_part("board", "box", {}, 500));
    board.rest({{"a1", 0.8}, {"a2", 0.1}, {"a3", 0.02}});
    body.hinge("pivot", point(board, 0, 0, 0), world(0, 0, 0), {0, 1, 0});
    Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
    ball.rest({{"r", radius}}).place({x, 0, 0.02 + radius + 1e-2}).move({0, 0, -speed}, {0, 0, 0});
    Simulation simulation(body, "rk4");
    const double m = ball.total_mass(), M = board.total_mass();
    const double inertia = M / 3 * (0.8 * 0.8 + 0.02 * 0.02);
    // The impulse at the arm x that parts them at e times the speed they met at.
    const double p = (1 + e) * speed / (1 / m + x * x / inertia);
    const ContactRecord& record = simulation.contact()->record();
    while (record.contacts.empty() && simulation.time() < 0.02) simulation.step(1e-3);
    REQUIRE_FALSE(record.contacts.empty());
    const State& state = simulation.state();
    CAPTURE(e, record.contacts.size());
    // The blow itself; after it the two may push on each other for the rest of the step.
    CHECK(record.impulses[0].norm() == Approx(p).epsilon(1e-9));
    Vec3<double> sum = Vec3<double>::Zero();
    for (std::size_t k = 0; k < record.contacts.size(); ++k)
      sum += (record.contacts[k].a.part == 1 ? 1 : -1) * record.impulses[k];
    CHECK((m * (state.v.segment<3>(6) - Vec3<double>(0, 0, -speed)) - sum).norm() < 1e-10 * p);
    CHECK(std::abs(state.v[6 + 2] + speed - p / m) < 1e-3 * speed);
    CHECK(state.v[4] == Approx(x * p / inertia).epsilon(1e-3));
    Workspace<double> work;
    const Dynamics& dynamics = simulation.dynamics();
    dynamics.evaluate_joints(state.time(), state.q, state.v, state.joints, simulation.model().islands()[0],
                             work);
    // The board's centre stays: the pivot takes up all of the impulse.
    const Vec3<double> taken = dynamics.joint_wrench(state.time(), 0, work, record.joint_impulses).force;
    CHECK((taken - sum).norm() < 1e-10 * p);
    CHECK(simulation.model().gap(state, 0) < 1e-12);
  }
}

TEST_CASE("N57: a joint that pulls a body through the floor holds, and what contact misses is said",
          "[contact][joints]") {
  MultiBody body;
  Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
  ball.rest({{"r", 0.1}}).place({0, 0, 0.3});
  floor(body);
  body.ball("pull", point(ball, 0, 0, 0), world(TimeVector(0, 0, test::wave(0.3, -0.4, 1))));
  Simulation simulation(body, "rk4");
  const double most = simulation.ledger().energy() + 0.5 * ball.total_mass() * 0.4 * 0.4;
  for (int i = 0; i < 1500; ++i) {
    simulation.step(2e-3);
    REQUIRE(simulation.model().gap(simulation.state(), 0) < 1e-12);
    REQUIRE(simulation.ledger().energy() <= most);
  }
  // As fast as the path goes on where the ball touches.
  CHECK(simulation.step_counters().contact_residual == Approx(0.4 * std::cos(std::asin(0.5))).epsilon(1e-2));
}

}  // namespace contact_balance_test
