// Steps with error control during lasting contact.
#include "catch.h"

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/joints/all_joints.h>

#include "motion.h"

namespace lasting_contact_test {

using namespace pliant;

namespace {

constexpr double kGravity = 9.81;  // m/s^2

void advance_to(Simulation& simulation, double end) {
  while (simulation.time() < end) simulation.step_up_to(end);
}

Part& ball_on_floor(MultiBody& body, double friction) {
  body.contact.active = true;
  body.contact.friction = friction;
  body.contact.planes.emplace_back().name = "floor";
  return body.add<Primitive<Sphere>>("ball")
      .rest({{"r", 0.1}})
      .place({0, 0, 0.1})
      .velocity({1, 0, 0}, {0, 0, 0});
}

/// Initial angle of the rolling ball in hill() from the vertical, rad.
constexpr double kStart = 0.2;
/// Adds a ball at rest on a larger fixed ball. The friction is so large that the ball rolls.
void hill(MultiBody& body) {
  body.contact.active = true;
  body.contact.friction = 2;
  body.add<Primitive<Sphere>>("hill").rest({{"r", 1}}).fix();
  body.add<Primitive<Sphere>>("ball")
      .rest({{"r", 0.1}})
      .place({1.1 * std::sin(kStart), 0, 1.1 * std::cos(kStart)});
}

/// Returns the angle (rad) of the rolling ball at time t (s), by RK4: (R + r) angle'' = 5/7 g sin(angle),
/// with the radii R = 1 m and r = 0.1 m.
double angle_on_hill(double t) {
  constexpr int steps = 4000;
  const double h = t / steps;
  auto acceleration = [](double angle) { return 5.0 / 7 * kGravity * std::sin(angle) / 1.1; };
  double angle = kStart, rate = 0;
  for (int i = 0; i < steps; ++i) {
    const double k1 = rate, l1 = acceleration(angle), k2 = rate + 0.5 * h * l1,
                 l2 = acceleration(angle + 0.5 * h * k1), k3 = rate + 0.5 * h * l2,
                 l3 = acceleration(angle + 0.5 * h * k2), k4 = rate + h * l3,
                 l4 = acceleration(angle + h * k3);
    angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    rate += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }
  return angle;
}

}  // namespace

TEST_CASE("the transitions from sliding to rest and to rolling are resolved within the tolerance",
          "[error][contact]") {
  for (const double tolerance : {1e-2, 1e-4, 1e-6, 1e-8}) {
    CAPTURE(tolerance);
    {  // The stopping distance is v^2 / (2 mu g).
      MultiBody body;
      body.add<Primitive<Box>>("box")
          .rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.1}})
          .place({0, 0, 0.1})
          .velocity({1, 0, 0}, {0, 0, 0});
      body.contact.active = true;
      body.contact.friction = 0.5;
      body.contact.planes.emplace_back().name = "floor";
      Simulation simulation(body, "dop853", 1, tolerance);
      advance_to(simulation, 0.5);
      CHECK(std::abs(simulation.state().q[0] - 1 / (2 * 0.5 * kGravity)) < std::max(0.5 * tolerance, 1e-8));
      CHECK(simulation.state().v.norm() < 1e-9);
      CHECK(simulation.step_counters().uncontrolled == 0);
      CHECK(simulation.step_counters().steps < 40);
    }
    {  // From the time 2 v / (7 mu g) the ball rolls, with 5/7 of its initial speed.
      MultiBody body;
      ball_on_floor(body, 0.2);
      Simulation simulation(body, "dop853", 1, tolerance);
      advance_to(simulation, 1);
      const double t_roll = 2 / (7 * 0.2 * kGravity),
                   x = t_roll - 0.5 * 0.2 * kGravity * t_roll * t_roll + 5.0 / 7 * (1 - t_roll);
      CHECK(std::abs(simulation.state().q[0] - x) < 0.5 * tolerance);
      CHECK(simulation.step_counters().steps < 40);
    }
  }
}

TEST_CASE(
    "the error of a ball that rolls down another ball is within the tolerance, with step lengths in "
    "proportion to the square root of the tolerance",
    "[error][contact]") {
  const double angle = angle_on_hill(0.5);
  auto rolling_steps = [&](double tolerance) {
    MultiBody body;
    hill(body);
    Simulation simulation(body, "dop853", 1, tolerance);
    advance_to(simulation, 0.5);
    const auto& q = simulation.state().q;
    CAPTURE(tolerance);
    CHECK(std::hypot(q[0] - 1.1 * std::sin(angle), q[2] - 1.1 * std::cos(angle)) < 0.3 * tolerance);
    CHECK(std::abs(std::hypot(q[0], q[2]) - 1.1) < 1e-7);
    CHECK(std::abs(simulation.ledger().balance) < tolerance);
    CHECK(simulation.step_counters().uncontrolled == 0);
    CHECK(simulation.step_counters().rejected < 10);
    return simulation.step_counters().steps;
  };
  rolling_steps(1e-3);
  rolling_steps(1e-4);
  const auto rough = rolling_steps(1e-5), fine = rolling_steps(1e-7);
  CHECK(fine < 12 * rough);
  CHECK(fine < 900);
}

TEST_CASE("a resting stack stays exactly at rest, in steps limited by the free fall within them",
          "[error][contact]") {
  for (const double tolerance : {1e-2, 1e-7}) {
    MultiBody body;
    body.contact.active = true;
    body.contact.planes.emplace_back().name = "floor";
    for (int i = 0; i < 5; ++i)
      body.add<Primitive<Box>>("box" + std::to_string(i))
          .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
          .place({0.01 * (i % 2), 0, 0.1 + 0.2 * i});
    Simulation simulation(body, "dop853", 1, tolerance);
    advance_to(simulation, 10);
    for (int i = 0; i < 5; ++i) {
      CHECK(std::abs(simulation.state().q[7 * i + 2] - 0.1 - 0.2 * i) < 1e-12);
      CHECK(std::abs(simulation.state().q[7 * i] - 0.01 * (i % 2)) < 1e-12);
    }
    // A box would fall by g h^2 / 2 in a step h without contact. The step is limited so that this fall is at
    // most 0.4 times the thickness of a box, which is 0.2 m.
    CHECK(simulation.step_counters().steps < 120);
    // Resting contacts alone need no step doubling.
    CHECK(simulation.step_counters().evaluations < 13 * simulation.step_counters().steps + 100);
  }
}

TEST_CASE("a ball that rolls off a table falls from the point where it leaves", "[error][contact]") {
  auto place = [](double tolerance) {
    MultiBody body;
    body.contact.active = true;
    body.contact.friction = 1;
    body.add<Primitive<Box>>("table").rest({{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.1}}).place({0, 0, -0.1}).fix();
    body.add<Primitive<Sphere>>("ball")
        .rest({{"r", 0.1}})
        .place({0.3, 0, 0.1})
        .velocity({1, 0, 0}, {0, 10, 0});
    Simulation simulation(body, "dop853", 1, tolerance);
    advance_to(simulation, 0.6);
    return Vec3<double>(simulation.state().q.head<3>());
  };
  const Vec3<double> exact = place(1e-8);
  CHECK(exact[0] > 0.6);
  CHECK(exact[2] < -0.1);
  for (const double tolerance : {1e-3, 1e-4, 1e-5, 1e-6}) {
    CAPTURE(tolerance, place(tolerance).transpose(), exact.transpose());
    CHECK((place(tolerance) - exact).norm() < 3 * tolerance);
  }
}

TEST_CASE("a pivoted board with a ball on it is hit by another ball, with an error within the tolerance",
          "[error][contact]") {
  auto end = [](double tolerance, long max_steps) {
    MultiBody body;
    Part& board = body.add<Primitive<Box>>("board").rest({{"a1", 1}, {"a2", 0.2}, {"a3", 0.03}});
    body.hinge("pivot", world(0, 0, 0), point(board, 0, 0, 0), Vec3<double>::UnitY());
    body.add<Primitive<Sphere>>("faller").rest({{"r", 0.1}}).place({0.7, 0, 1});
    body.add<Primitive<Sphere>>("flyer").rest({{"r", 0.1}}).place({-0.7, 0, 0.2});
    body.contact.active = true;
    Simulation simulation(body, "dop853", 1, tolerance);
    advance_to(simulation, 0.8);
    CAPTURE(tolerance);
    CHECK(simulation.step_counters().uncontrolled == 0);
    CHECK(simulation.step_counters().steps < max_steps);
    CHECK(simulation.model().gap(simulation.state(), 0) < 1e-12);
    return simulation.state();
  };
  const State exact = end(1e-7, 5000);
  for (const auto& [tolerance, max_steps] :
       std::vector<std::pair<double, long>>{{1e-2, 60}, {1e-3, 80}, {1e-5, 600}}) {
    const State state = end(tolerance, max_steps);
    for (int part = 0; part < 3; ++part)
      CHECK((state.q - exact.q).segment<3>(7 * part).norm() < std::max(0.5 * tolerance, 1e-6));
  }
}

TEST_CASE("stiff parameters of a part on a floor are resolved", "[error][contact]") {
  auto end = [](double tolerance) {
    MultiBody body;
    body.contact.active = true;
    body.contact.planes.emplace_back().name = "floor";
    Part& egg = body.add<Primitive<Ellipsoid>>("egg");
    egg.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}})
        .place({0, 0, 0.11})
        .velocity({0.5, 0, 0}, {0.3, 0.1, 0.2});
    egg.stiffness({{"a1", 1e5}, {"a2", 1e5}, {"a3", 1e5}}).damping(0, 1e-3);
    Simulation simulation(body, "esdirk", 1, tolerance);
    advance_to(simulation, 0.5);
    CHECK(simulation.step_counters().uncontrolled == 0);
    return simulation.state();
  };
  const State exact = end(1e-6), rough = end(1e-4);
  CHECK((exact.q - rough.q).head<3>().norm() < 1e-4);
  CHECK((exact.q - rough.q).tail<3>().norm() < 1e-4);
}

TEST_CASE("with many parts that may meet the steps are short and counted as uncontrolled",
          "[error][contact]") {
  MultiBody body;
  body.contact.active = true;
  body.contact.friction = 0.5;
  // No interval of clusters (include/pliant/simulate/README.md) ends in these runs; its end would end a step.
  body.contact.interval = 1;  // s
  body.contact.planes.emplace_back().name = "floor";
  for (int i = 0; i < 9; ++i)
    body.add<Primitive<Box>>("box" + std::to_string(i))
        .rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.1}})
        .place({0, 0.4008 * i, 0.1})
        .velocity({1, 0, 0}, {0, 0, 0});
  Simulation simulation(body, "dop853", 1, 1e-6);
  advance_to(simulation, 0.25);
  CHECK(simulation.state().q[0] == Approx(1 / (2 * 0.5 * kGravity)).margin(1e-3));
  CHECK(simulation.state().v.norm() < 1e-9);
  CHECK(simulation.step_counters().uncontrolled >= 125);  // steps of at most 2 ms
  CHECK(simulation.step_counters().uncontrolled < 150);
  const auto steps = [&](double longest) {
    body.contact.longest_step = longest;
    Simulation other(body, "dop853", 1, 1e-6);
    advance_to(other, 0.1);
    return other.step_counters().uncontrolled;
  };
  const auto default_steps = steps(2e-3);
  CHECK(default_steps >= 50);
  CHECK(default_steps < 60);
  CHECK(steps(5e-4) >= 4 * default_steps - 20);
  body.contact.longest_step = 2e-3;
  Simulation rough(body, "dop853", 1, 1e-2);
  advance_to(rough, 0.5);
  CHECK(rough.step_counters().uncontrolled <= 27);
  CHECK(rough.state().q[0] == Approx(1 / (2 * 0.5 * kGravity)).margin(0.2e-2));
}

TEST_CASE("a part driven by a force does not pass through a thin plate, from any distance",
          "[error][contact][long]") {
  for (const double tolerance : {0.0, 1e-3, 1e-6})
    for (const double from : {0.1, 0.37, 0.83, 1.9})
      for (const double force : {0.5, 5.0, 40.0}) {
        MultiBody body;
        body.gravity.setZero();
        body.contact.active = true;
        body.add<Primitive<Box>>("plate").rest({{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.005}}).fix();
        Part& ball = body.add<Primitive<Sphere>>("ball").rest({{"r", 0.02}}).place({0.03, 0.01, from});
        body.force("push", point(ball, 0, 0, 0), {0, 0, -force});
        Simulation simulation(body, "dop853", 1, tolerance);
        for (int i = 0; i < 40; ++i) simulation.step(0.05);
        CAPTURE(tolerance, from, force);
        CHECK(simulation.state().q[2] > 0.02);
      }
}

TEST_CASE("the motion of a plane that returns to its position within a step is detected",
          "[error][contact]") {
  // The plane oscillates with three times the acceleration of gravity, so that a box on it is thrown up.
  MultiBody body;
  body.contact.active = true;
  body.add<Primitive<Box>>("box").rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.2}}).place({0, 0, 0.2});
  ContactPlane& plane = body.contact.planes.emplace_back();
  plane.name = "table";
  plane.point = TimeVector(0, 0, TimeFunction::formula("0.00745 * (1 - cos(20 * pi * t))"));
  Simulation simulation(body, "dop853", 1, 1e-4);

  for (int i = 0; i < 20; ++i) simulation.step(0.1);  // the step is a period of the plane
  CHECK(simulation.step_counters().impacts >= 10);
  CHECK(simulation.step_counters().steps > 40);
}

TEST_CASE("the limit of uncontrolled steps (longest_step) does not affect controlled steps",
          "[error][contact]") {
  auto end = [](double longest) {
    MultiBody body;
    hill(body);
    body.contact.longest_step = longest;
    Simulation simulation(body, "dop853", 1, 1e-4);
    advance_to(simulation, 0.5);
    return simulation.state().q;
  };
  CHECK(end(2e-3) == end(100));
}

TEST_CASE("a plane that is removed ends a step, at any time and with any tolerance", "[error][contact]") {
  for (const double off : {0.5, 100.0}) {
    MultiBody body;
    body.contact.active = true;
    body.add<Primitive<Box>>("box").rest({{"a1", 2e-3}, {"a2", 2e-3}, {"a3", 2e-3}}).place({0, 0, 2e-3});
    ContactPlane& plane = body.contact.planes.emplace_back();
    plane.name = "table";
    plane.off = off;
    Simulation simulation(body, "dop853", 1, 1e-10);
    advance_to(simulation, off + 0.1);
    CAPTURE(off);
    CHECK(simulation.state().q[2] == Approx(2e-3 - 0.5 * kGravity * 0.01).epsilon(1e-9));
  }
}

TEST_CASE("a thin part that slides fast on a floor needs no divided steps", "[contact]") {
  MultiBody body;
  body.contact.active = true;
  body.contact.friction = 0;
  body.contact.planes.emplace_back().name = "floor";
  body.add<Primitive<Box>>("puck")
      .rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.01}})
      .place({0, 0, 0.01})
      .velocity({10, 0, 0}, {0, 0, 0});
  Simulation simulation(body, "semi_implicit_euler");
  for (int i = 0; i < 20; ++i) simulation.step(0.01);
  CHECK(simulation.step_counters().evaluations == 20);
  CHECK(simulation.state().q[0] == Approx(2).epsilon(1e-12));
}

TEST_CASE("a ball that leaves the floor lands again in the same step, at the exact time", "[contact]") {
  for (const char* method : {"rk4", "dop853"}) {
    MultiBody body;
    body.contact.active = true;
    body.contact.restitution = 1;
    body.contact.planes.emplace_back().name = "floor";
    body.add<Primitive<Sphere>>("ball")
        .rest({{"r", 0.1}})
        .place({0, 0, 0.1})
        .velocity({0, 0, 0.03}, {0, 0, 0});
    Simulation simulation(body, method);
    simulation.step(0.01);
    // With the initial velocity u = 0.03 m/s upwards, the ball lands after 2 u / g = 6.1 ms.
    const double since = 0.01 - 2 * 0.03 / kGravity;
    CAPTURE(method);
    CHECK(simulation.step_counters().impacts == 1);
    CHECK(simulation.state().q[2] - 0.1 ==
          Approx(0.03 * since - 0.5 * kGravity * since * since).epsilon(1e-9));
    CHECK(simulation.state().v[2] == Approx(0.03 - kGravity * since).epsilon(1e-9));
  }
}

TEST_CASE("a part that a force presses on a floor without gravity needs no repeated steps", "[contact]") {
  MultiBody body;
  body.gravity = Vec3<double>::Zero();
  body.contact.active = true;
  body.contact.planes.emplace_back().name = "floor";
  Part& log = body.add<Primitive<Ellipsoid>>("log").rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.5}});
  log.place({0, 0, 0.12}, Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitX())));
  body.force("push", point(log, 0, 0), TimeVector(0, 0, -50));
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 200; ++i) simulation.step(2.5e-3);
  CHECK(simulation.state().q[2] == Approx(0.1).epsilon(1e-9));
  CHECK(simulation.step_counters().evaluations < 15 * 200);
}

TEST_CASE("a ball that rocks about its heavy side: errors fall with the tolerance, in few steps") {
  // The centre of mass is at the distance d from the centre of the ball, which rolls without slip. At the
  // angle theta, (I + m (r^2 + d^2 - 2 r d cos theta)) theta'' = -m d sin theta (g + r theta'^2), where I is
  // the moment of inertia about the centre of mass.
  constexpr double r = 0.2, d = 0.08, m = 10, I = 0.1, start = 1.2, end = 1.5;
  double theta = start, rate = 0;
  constexpr int n = 20000;
  const auto acceleration = [&](double angle, double speed) {
    return -m * d * std::sin(angle) * (kGravity + r * speed * speed) /
           (I + m * (r * r + d * d - 2 * r * d * std::cos(angle)));
  };
  for (int i = 0; i < n; ++i) {
    const double h = end / n, k1 = rate, l1 = acceleration(theta, rate), k2 = rate + 0.5 * h * l1,
                 l2 = acceleration(theta + 0.5 * h * k1, k2), k3 = rate + 0.5 * h * l2,
                 l3 = acceleration(theta + 0.5 * h * k2, k3), k4 = rate + h * l3,
                 l4 = acceleration(theta + h * k3, k4);
    theta += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    rate += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  }
  for (const double tolerance : {9e-5, 1e-5, 1e-6, 1e-7}) {
    MultiBody body;
    ball_on_floor(body, 2)
        .rest({{"r", r}})
        .inertia(m, Vec3<double>(I + m * d * d, I + m * d * d, I).asDiagonal(), {0, 0, -d})
        .place({0, 0, r}, Eigen::Quaterniond(Eigen::AngleAxisd(start, Vec3<double>::UnitY())))
        .velocity({0, 0, 0}, {0, 0, 0});
    Simulation simulation(body, "dop853", 1, tolerance);
    advance_to(simulation, end);
    const double x = simulation.state().q[0], error = std::abs(x - r * (theta - start));
    CAPTURE(tolerance, x, r * (theta - start), error, simulation.step_counters().steps);
    CHECK(error < 10 * tolerance * r);
    CHECK(static_cast<double>(simulation.step_counters().steps) < 110 * std::cbrt(1e-4 / tolerance));
  }
}

}  // namespace lasting_contact_test
