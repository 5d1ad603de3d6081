// Planes that appear inside parts, impacts on a board supported by a floor and a hinge, strings that become
// taut. The ledger records the work of impulses, and changes of momentum equal the reported impulses.
// N58, N59 and N60 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <pliant/body/joints/all_joints.h>
#include <pliant/contact/contact_stepping.h>

#include "motion.h"

namespace stress_impacts_test {

using namespace pliant;

namespace {

constexpr double kRadius = 0.1;  // m

Part& ball(MultiBody& body, const std::string& name, const Vec3<double>& at) {
  return body.add(make_part(name, "ellipsoid", {}, 1000))
      .rest({{"a1", kRadius}, {"a2", kRadius}, {"a3", kRadius}})
      .place(at);
}
Point centre(Part& part) {
  return point(part, 0, 0, 0);
}
double work(const Ledger& ledger, Work kind) {
  return ledger.work[static_cast<int>(kind)];
}

}  // namespace

TEST_CASE("N58: a moving plane that appears in a ball does the work that the ball gains", "[contact]") {
  for (const char* method : {"rk4", "semi_implicit_euler"})
    for (const double e : {0.0, 0.5, 1.0})
      for (const double speed : {0.0, 2.0}) {
        MultiBody body;
        body.gravity.setZero();
        body.contact.restitution = e;
        const Part& part = ball(body, "ball", {0, 0, 0.05});
        body.plane("hand", TimeVector(0, 0, TimeFunction::formula(std::to_string(speed) + " * (t - 0.05)")),
                   {0, 0, 1})
            .on = 0.05;
        Simulation simulation(body, method);
        const double h = 1e-3, v = (1 + e) * speed, energy = 0.5 * part.total_mass() * v * v;
        double impulses = 0;
        CAPTURE(method, e, speed);
        for (int i = 0; i < 600; ++i) {
          const double before = simulation.state().q[2];
          simulation.step(h);
          // The separation adds at most one size of the ball (its radius) per second to the velocity after
          // the impulse.
          REQUIRE(simulation.state().q[2] - before <= h * (v + kRadius) * (1 + 1e-9));
          REQUIRE(simulation.state().v[2] <= v * (1 + 3e-11));
          REQUIRE(work(simulation.ledger(), Work::contact) <= energy * (1 + 3e-11));
          for (const Vec3<double>& p : simulation.contact()->impulses()) impulses += p[2];
        }
        const Ledger ledger = simulation.ledger();
        CHECK(work(ledger, Work::contact) == Approx(energy).epsilon(3e-11));
        CHECK(ledger.kinetic == Approx(energy).epsilon(3e-11));
        CHECK(impulses == Approx(part.total_mass() * v).epsilon(3e-11));
        CHECK(std::abs(ledger.balance) < 1e-12);
        CHECK(simulation.state().q[2] - speed * (simulation.time() - 0.05) >= 0.05);
      }
}

TEST_CASE("N59: a ball hits a board on a floor and a hinge: changes of momentum equal the reported impulses",
          "[contact][joints]") {
  const bool flexible = GENERATE(false, true);
  constexpr double kTilt = 0.2, kSpeed = 3;
  for (const double e : {0.0, 0.5})
    for (const double mu : {0.0, 0.5})
      for (const double x : {-0.5, -0.2, 0.5}) {  // x < 0: on the arm that the floor supports
        CAPTURE(flexible, e, mu, x);
        MultiBody body;
        body.gravity.setZero();
        body.contact.friction = mu;
        body.contact.restitution = e;
        const Eigen::Quaterniond R(Eigen::AngleAxisd(-kTilt, Vec3<double>::UnitY()));
        const Vec3<double> middle(0, 0, 0.8 * std::sin(kTilt) + 0.02 * std::cos(kTilt)),
            up = R * Vec3<double>::UnitZ();
        Part& board = body.add(make_part("board", "box", {"bend"}, 500));
        board.rest({{"a1", 0.02}, {"a2", 0.1}, {"a3", 0.8}, {"bend.angle", 0}});
        board.place(middle, R * Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitY())));
        if (flexible) board.stiffness({{"bend.angle", 400}});
        body.hinge("pivot", centre(board), world(middle), {0, 1, 0});
        body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
        Part& ball_part =
            ball(body, "ball", middle + R * Vec3<double>(x, 0.03, 0.02) + (kRadius + 5e-3) * up);
        ball_part.velocity({0.3, 0, -kSpeed}, {0, 0, 0});
        Simulation simulation(body, "dop853", 1, 1e-10);
        const Model& model = simulation.model();
        const ContactRecord& record = simulation.contact()->record();
        const Ledger before = simulation.ledger();
        const VecX<double> v = simulation.state().v;
        // Steps with error control end at the impact.
        while (simulation.step_counters().impacts == 0) {
          REQUIRE(simulation.time() < 0.02);
          simulation.step_up_to(0.02);
        }
        Vec3<double> ball_impulse = Vec3<double>::Zero(), floor_impulse = Vec3<double>::Zero(),
                     angular_impulse = Vec3<double>::Zero(), contact_point = Vec3<double>::Zero();
        for (std::size_t k = 0; k < record.contacts.size(); ++k) {
          const Contact& contact = record.contacts[k];
          if (contact.plane < 0) {
            ball_impulse += (contact.a.part == 1 ? 1 : -1) * record.impulses[k];
            contact_point = contact.x;
            continue;
          }
          floor_impulse += record.impulses[k];
          angular_impulse += contact.x.cross(record.impulses[k]);
        }
        Workspace<double> work;
        const State& state = simulation.state();
        const Dynamics& dynamics = simulation.dynamics();
        dynamics.evaluate_joints(state.time(), state.q, state.v, state.joints, model.islands()[0], work);
        const Wrench pivot = dynamics.joint_wrench(state.time(), 0, work, record.joint_impulses);
        angular_impulse += middle.cross(pivot.force) + pivot.torque;
        const double scale = ball_impulse.norm();
        const int ball_v0 = model.parts()[1].v0;
        const Ledger after = simulation.ledger();
        CHECK((ball_part.total_mass() * (state.v - v).segment<3>(ball_v0) - ball_impulse).norm() <
              1e-10 * scale);
        CHECK((after.momentum - before.momentum - floor_impulse - pivot.force).norm() < 1e-10 * scale);
        CHECK((after.angular_momentum - before.angular_momentum - angular_impulse).norm() < 1e-10 * scale);
        CHECK(model.gap(state, 0) < 1e-12);
        CHECK(after.energy() < before.energy());
        if (flexible || mu > 0 || x > 0) continue;
        // Reference for a rigid smooth board: the normal velocity of the ball is reversed and multiplied by
        // e, and the floor and the hinge support the board.
        const double p =
            (1 + e) * ball_part.total_mass() * (kSpeed * std::cos(kTilt) + 0.3 * std::sin(kTilt));
        CHECK((ball_impulse - p * up).norm() < 2e-8 * p);
        const double arm = 0.8 * std::cos(kTilt) - 0.02 * std::sin(kTilt);
        CHECK(floor_impulse[2] ==
              Approx(-p * (R.inverse() * (contact_point - middle))[0] / arm).epsilon(1e-9));
      }
}

TEST_CASE("N60: the ends of a slack string pass each other, and the string stops them on the other side",
          "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler", "linearly_implicit", "dop853"}) {
    CAPTURE(method);
    MultiBody body;
    body.gravity.setZero();
    Part& mass = ball(body, "mass", {-0.3, 0, 0}).velocity({1, 0, 0}, {0, 0, 0});
    body.join("string", String{0.5}, {world(0, 0, 0), centre(mass)});
    Simulation simulation(body, method);
    const double energy = simulation.ledger().energy();
    test::run(simulation, 0.3, 300);
    CHECK(std::abs(simulation.state().q[0]) < 1e-14);
    CHECK(simulation.state().v[0] == 1);
    CHECK(simulation.state().joints[0] == JointMode::slack);
    for (int i = 0; i < 800; ++i) {
      simulation.step(1e-3);
      REQUIRE(simulation.state().q.head<3>().norm() <= 0.5 * (1 + 1e-9));
    }
    CHECK(simulation.state().q[0] == Approx(0.5).epsilon(1e-12));
    CHECK(simulation.state().v.norm() < 1e-12);
    CHECK(work(simulation.ledger(), Work::limits) == Approx(-energy).epsilon(1e-11));
  }
}

TEST_CASE(
    "a swinging string becomes slack where its tension vanishes, and taut again at the end of the free fall",
    "[joints]") {
  // The mass starts at the bottom with v^2 = 3.5 g l. The string becomes slack when the mass is
  // l (v^2 / (g l) - 2) / 3 above the hook.
  const double l = 1, g = 9.81;
  for (const double h : {2e-3, 1e-3, 5e-4}) {
    MultiBody body;
    Part& mass = ball(body, "mass", {0, 0, -l}).velocity({std::sqrt(3.5 * g * l), 0, 0}, {0, 0, 0});
    body.join("string", String{l}, {world(0, 0, 0), centre(mass)});
    Simulation simulation(body, "rk4");
    const State& state = simulation.state();
    test::run(simulation, h, 1);
    while (state.joints[0] == JointMode::closed) {
      REQUIRE(simulation.time() < 1);
      simulation.step(h);
    }
    CHECK(state.joints[0] == JointMode::slack);
    CHECK(state.q[2] == Approx(0.5 * l).margin(4e-5));  // 1.1e-5 m has been observed, for each step length
    // The path is a parabola until the distance from the hook is l again.
    const double t = simulation.time();
    const Vec3<double> x = state.q.head<3>(), v = state.v.head<3>();
    while (state.joints[0] == JointMode::slack) {
      REQUIRE(simulation.time() < 2);
      const double s = simulation.time() - t;
      REQUIRE((state.q.head<3>() - (x + s * v - 0.5 * g * s * s * Vec3<double>::UnitZ())).norm() < 1e-12);
      simulation.step(h);
    }
    CHECK(state.joints[0] == JointMode::closed);
    CHECK(state.q.head<3>().norm() == Approx(l).epsilon(1e-9));
    CHECK(std::abs(state.q.head<3>().dot(state.v.head<3>())) < 1e-10);
    CHECK(std::abs(simulation.ledger().balance) < 1e-6);
  }
}

TEST_CASE("N60: two strings that become taut at once between free parts conserve their momenta", "[joints]") {
  for (const char* method : {"rk4", "dop853"}) {
    CAPTURE(method);
    MultiBody body;
    body.gravity.setZero();
    Part& a = ball(body, "a", {-0.2, 0, 0}).velocity({-1, 0.1, 0}, {0, 0, 0});
    Part& b = body.add(make_part("b", "box", {}, 500));
    b.rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.1}}).place({0.2, 0, 0}).velocity({1, -0.1, 0.05}, {0, 0, 0});
    for (const double side : {-1.0, 1.0})
      body.join(side < 0 ? "left" : "right", String{0.45},
                {point(a, 0, side * kPi / 2), point(b, 0, side * kPi / 2)});
    Simulation simulation(body, method);
    const Ledger before = simulation.ledger();
    Workspace<double> scratch;
    for (int i = 0; i < 500; ++i) {
      simulation.step(1e-3);
      const State& state = simulation.state();
      const bool taut = state.joints[0] == JointMode::closed || state.joints[1] == JointMode::closed;
      for (int j = 0; j < 2; ++j)
        if (state.joints[static_cast<std::size_t>(j)] == JointMode::closed)
          REQUIRE(simulation.model().gap(state, j) <= 1e-9 * 0.45);
      if (!taut) continue;
      simulation.dynamics().accelerations(state.time(), state.q, state.v, state, scratch);
      REQUIRE(scratch.joints.lambda.minCoeff() >= 0);
    }
    const Ledger after = simulation.ledger();
    CHECK((after.momentum - before.momentum).norm() < 1e-13);
    CHECK((after.angular_momentum - before.angular_momentum).norm() < 1e-13);
    // The parts separated at 2 m/s, and now rotate about each other.
    CHECK(work(after, Work::limits) == Approx(after.energy() - before.energy()).epsilon(1e-11));
    CHECK(after.energy() < 0.2 * before.energy());
    for (const JointMode mode : simulation.state().joints) CHECK(mode == JointMode::closed);
  }
}

}  // namespace stress_impacts_test
