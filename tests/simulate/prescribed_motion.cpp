// Joints, springs and contacts with parts that have prescribed motion. The results are compared with those of
// moving anchors and with closed forms.
#include "catch.h"

#include <cmath>

#include <pliant/contact/contact_stepping.h>
#include "draws.h"

#include "motion.h"

namespace prescribed_motion_test {

using namespace pliant;
using test::wave;

namespace {

constexpr double kG = 9.81;  // m/s^2

Part& ball(MultiBody& body, const char* name, double r) {
  return body.add(make_part(name, "sphere", {}, 1000)).rest({{"r", r}});
}
Part& box(MultiBody& body, const char* name, const Vec3<double>& half) {
  return body.add(make_part(name, "box", {}, 1000)).rest({{"a1", half[0]}, {"a2", half[1]}, {"a3", half[2]}});
}
PrescribedMotion along(TimeVector position) {
  PrescribedMotion motion;
  motion.position = std::move(position);
  return motion;
}
double work(Simulation& simulation, Work kind) {
  return simulation.ledger().work[static_cast<int>(kind)];
}

}  // namespace

TEST_CASE("a load on a part with prescribed motion moves as on the equivalent moving anchor", "[motion]") {
  // The anchor is 0.1 m from the origin of a frame that translates and rotates periodically. In the second
  // model this frame is the frame of a part.
  const TimeFunction x = wave(0, 0.2, 7), angle = wave(0.3, 1.5, 3);
  const TimeVector anchor(TimeFunction::formula("0.2 * sin(7 * t) + 0.1 * cos(0.3 + 1.5 * sin(3 * t))"),
                          TimeFunction::formula("0.1 * sin(0.3 + 1.5 * sin(3 * t))"), 1);
  for (const char* method : {"semi_implicit_euler", "rk4", "linearly_implicit"})
    for (const bool on_spring : {false, true}) {
      std::vector<std::unique_ptr<Simulation>> runs;
      MultiBody bodies[2];
      for (MultiBody& body : bodies) {
        const bool on_part = &body == &bodies[1];
        Part& bob = ball(body, "bob", 0.1).place({0.1, 0, 0.5});
        Point hook = world(anchor);
        if (on_part) {
          PrescribedMotion motion = along({x, 0, 1});
          motion.angle = angle;
          hook = point(ball(body, "hand", 0.1).prescribe(motion), 0, 0);
        }
        if (on_spring)
          body.spring("spring", hook, point(bob, kPi / 2, 0), 200, 3, 0.3);
        else
          body.ball("hook", point(bob, kPi / 2, 0), hook);
        body.stabilization.assemble_first = !on_spring;
        runs.push_back(std::make_unique<Simulation>(body, method));
        test::run(*runs.back(), 1, 1000);
      }
      INFO(method << (on_spring ? ", spring" : ", joint"));
      CHECK((runs[0]->state().q - runs[1]->state().q).lpNorm<Eigen::Infinity>() < 1e-12);
      CHECK((runs[0]->state().v - runs[1]->state().v).lpNorm<Eigen::Infinity>() < 1e-11);
      const double anchors = work(*runs[0], Work::anchors);
      CHECK(std::abs(anchors) > 0.01);
      CHECK(work(*runs[1], Work::anchors) == Approx(anchors).epsilon(1e-10));
      if (method == std::string("rk4")) CHECK(std::abs(runs[1]->ledger().balance) < 1e-6);
    }
}

TEST_CASE("a ball leaves a paddle of constant speed at 1 + e times the speed of the paddle", "[motion]") {
  constexpr double kSpeed = 3;
  for (const double e : {0.0, 0.6, 1.0}) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    body.contact.restitution = e;
    box(body, "paddle", {0.05, 0.5, 0.5}).prescribe(along({TimeFunction::formula("3 * t - 1"), 0, 0}));
    Part& hit = ball(body, "ball", 0.1);
    Simulation simulation(body, "rk4");
    test::run(simulation, 1, 100);
    const double m = hit.total_mass(), v = (1 + e) * kSpeed;
    CHECK(simulation.state().v[0] == Approx(v).epsilon(1e-10));
    const double hit_time = (1 - 0.15) / kSpeed;
    CHECK(simulation.state().q[0] == Approx(v * (1 - hit_time)).epsilon(1e-9));
    CHECK(simulation.ledger().momentum[0] == Approx(m * v).epsilon(1e-10));
    CHECK(work(simulation, Work::contact) == Approx(0.5 * m * v * v).epsilon(1e-9));
    CHECK(std::abs(simulation.ledger().balance) < 1e-9);
  }
}

TEST_CASE("a thin fast paddle does not pass through a ball", "[motion][long]") {
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  PrescribedMotion motion = along({0, 0, 0});
  motion.angle = TimeFunction::formula("100 * t - 1.5");
  box(body, "paddle", {1, 0.005, 0.1}).prescribe(motion);
  ball(body, "ball", 0.05).place({0.8, 0, 0});
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.02, 2);
  CHECK(simulation.state().v[1] > 50);
}

TEST_CASE("a rising platform carries a ball, and pushes it with m (g + a)", "[motion]") {
  MultiBody body;
  body.contact.active = true;
  box(body, "platform", {0.5, 0.5, 0.05}).prescribe(along({0, 0, TimeFunction::formula("t^2 - 0.05")}));
  Part& load = ball(body, "ball", 0.1).place({0, 0, 0.1});
  Simulation simulation(body, "rk4");
  const double h = 2e-3;
  double worst = 0;
  for (int i = 0; i < 500; ++i) {
    simulation.step(h);
    const double t = simulation.time();
    worst = std::max(worst, std::abs(simulation.state().q[2] - 0.1 - t * t));
  }
  CHECK(worst < 1e-8);
  const double m = load.total_mass();
  CHECK(simulation.state().v[2] == Approx(2).epsilon(1e-3));
  Vec3<double> impulse = Vec3<double>::Zero();
  REQUIRE(!simulation.contact()->contacts().empty());
  for (std::size_t k = 0; k < simulation.contact()->contacts().size(); ++k) {
    const Contact& contact = simulation.contact()->contacts()[k];
    CHECK(contact.normal[2] == Approx(contact.a.part == 1 ? 1 : -1));
    impulse += simulation.contact()->impulses()[k] * (contact.a.part == 1 ? 1 : -1);
  }
  CHECK(impulse[2] == Approx(m * (kG + 2) * h).epsilon(1e-2));
  CHECK(work(simulation, Work::contact) == Approx(m * (kG + 0.5 * 4)).epsilon(2e-3));
  // The model also gives the position of a part with prescribed motion, at the time of the state.
  CHECK(simulation.model().position(simulation.state(), 0)[2] == Approx(0.95));
}

TEST_CASE("a ball that rolls on a turntable circles at 2/7 of the rate of the table", "[motion][long]") {
  constexpr double kRate = 3, kRadius = 0.1, kTurn = 2.0 / 7 * kRate;
  std::vector<double> errors;
  for (const double h : {4e-3, 2e-3, 1e-3}) {
    MultiBody body;
    body.contact.active = true;
    body.contact.friction = 2;
    PrescribedMotion motion = along({0, 0, -0.05});
    motion.angle = TimeFunction::formula("3 * t");
    box(body, "table", {1, 1, 0.05}).prescribe(motion);
    const Vec3<double> n(0, 0, 1), x(0.4, 0, kRadius), v(0, 0.3, 0);
    const Vec3<double> slip = v - kRate * n.cross(x);
    ball(body, "ball", kRadius).place(x).velocity(v, n.cross(slip) / kRadius);
    Simulation simulation(body, "rk4");
    test::run(simulation, 2, static_cast<int>(std::lround(2 / h)));
    const double angle = kTurn * 2;
    const Vec3<double> exact =
        x + Vec3<double>(0.3 / kTurn * (std::cos(angle) - 1), 0.3 / kTurn * std::sin(angle), 0);
    errors.push_back((simulation.state().q.head<3>() - exact).norm());
    CHECK(simulation.state().v.head<2>().norm() == Approx(0.3).epsilon(5 * h));
  }
  CAPTURE(errors[0], errors[1], errors[2]);
  CHECK(errors.back() < 1e-5);
  CHECK(test::observed_order(errors) > 1.8);
}

TEST_CASE("invalid prescribed motions are refused by name", "[motion]") {
  MultiBody body;
  Part& hand = ball(body, "hand", 0.1);
  PrescribedMotion motion;
  motion.axis.setZero();
  CHECK_THROWS_WITH(hand.prescribe(motion), test::has_text("'hand': the axis"));
  motion.axis = {0, 0, 2};
  motion.position = TimeVector(TimeFunction::formula("1 / t"), 0, 0);
  CHECK_THROWS_WITH(hand.prescribe(motion), test::has_text("not finite at time 0"));
  hand.prescribe(along({0, 0, TimeFunction::formula("t")}));
  CHECK_THROWS_WITH(hand.fix(), test::has_text("prescribed"));
  CHECK_THROWS_WITH(hand.place({0, 0, 0}), test::has_text("prescribed"));
  CHECK_THROWS_WITH(ball(body, "stone", 1).fix().prescribe({}), test::has_text("fixed"));
  hand.make_dynamic({"r"});
  CHECK_THROWS_WITH(Model(body), test::has_text("prescribed motion has no dynamic parameters"));
  MultiBody soft;
  ball(soft, "jelly", 0.1).deform_locally({}).prescribe({});
  CHECK_THROWS_WITH(Model(soft), test::has_text("prescribed motion does not deform locally"));
}

TEST_CASE("a prescribed motion that ceases to be finite stops the run with a message that names the part",
          "[motion]") {
  MultiBody body;
  Part& hand = ball(body, "hand", 0.1).prescribe(along({TimeFunction::formula("sqrt(0.045 - t)"), 0, 0}));
  Part& bob = ball(body, "bob", 0.1).place({0, 0, -1});
  body.spring("spring", point(hand, 0, 0), point(bob, 0, 0), 10);
  Simulation simulation(body, "rk4");
  CHECK_THROWS_WITH(test::run(simulation, 0.1, 10), test::has_text("motion of part 'hand'"));
}

}  // namespace prescribed_motion_test
