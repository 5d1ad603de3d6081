// Sliding that begins, stops or reverses in runs to a tolerance: a table of problems with closed forms, whose
// errors fall with the tolerance. The restitution of a hinged bar does not depend on the steps.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <pliant/body/joints/all_joints.h>
#include <pliant/contact/contact_stepping.h>

#include "motion.h"

namespace friction_events_test {

using namespace pliant;

namespace {

constexpr double kGravity = 9.81, kRadius = 0.1;  // m/s^2; radius of the ball, m

/// A scene and the exact position of one part at the end of the run.
struct Problem {
  const char* name;
  double end;  ///< s
  void (*scene)(MultiBody&);
  Vec3<double> (*exact)();
  bool constant_forces = true;  ///< whether all forces are constant between the events
  int part = 0;
};

void floor(MultiBody& body, double friction) {
  body.contact.friction = friction;
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
/// Adds a floor that moves along x. x: formula of the displacement of the floor, m.
void belt(MultiBody& body, double friction, const char* x) {
  body.contact.friction = friction;
  body.plane("belt", TimeVector(TimeFunction::formula(x), 0, 0), {0, 0, 1});
}
/// Adds a box with the half extents 0.2, 0.2 and 0.05 m on the floor.
Part& block(MultiBody& body, double x = 0, double speed = 0) {
  return body.add<Primitive<Box>>("block")
      .rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.05}})
      .place({x, 0, 0.05})
      .velocity({speed, 0, 0}, {0, 0, 0});
}
constexpr double kBlockMass = 1000 * 0.4 * 0.4 * 0.1;  // kg
Vec3<double> on_floor(double x) {
  return {x, 0, 0.05};
}
Part& ball(MultiBody& body, double speed, double spin) {
  return body.add<Primitive<Sphere>>("ball")
      .rest({{"r", kRadius}})
      .place({0, 0, kRadius})
      .velocity({speed, 0, 0}, {0, spin, 0});
}
Part& cylinder(MultiBody& body, double radius, double half_length) {
  return body.add<Primitive<Cylinder>>("cylinder")
      .rest({{"a1", radius}, {"a2", radius}, {"a3", half_length}});
}
Vec3<double> ball_at(double x) {
  return {x, 0, kRadius};
}
Eigen::Quaterniond turned(double angle, const Vec3<double>& axis) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis));
}

/// Returns the displacement after t seconds with the initial speed v and the acceleration a.
double moved(double v, double a, double t) {
  return v * t + 0.5 * a * t * t;
}
/// Returns the distance in which the speed v decreases to zero with the deceleration a.
double stopped(double v, double a) {
  return v * v / (2 * a);
}

// The angle at which the plane of slope() rises along -x, rad. on_slope() returns the point at the distance s
// uphill from the origin and at a height above the plane, m.
constexpr double kSlope = 0.5;
void slope(MultiBody& body, double friction) {
  body.contact.friction = friction;
  body.plane("slope", Vec3<double>(0, 0, 0), {std::sin(kSlope), 0, std::cos(kSlope)});
}
Vec3<double> uphill() {
  return {-std::cos(kSlope), 0, std::sin(kSlope)};
}
Vec3<double> on_slope(double s, double height) {
  return s * uphill() + height * Vec3<double>(std::sin(kSlope), 0, std::cos(kSlope));
}
/// Returns the acceleration uphill by gravity and by an uphill friction force, m/s^2. friction: the friction
/// force divided by the normal force.
double along_slope(double friction) {
  return kGravity * (friction * std::cos(kSlope) - std::sin(kSlope));
}
void block_uphill(MultiBody& body, double friction) {
  slope(body, friction);
  body.add<Primitive<Box>>("block")
      .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.05}})
      .place(on_slope(0, 0.05), turned(kSlope, Vec3<double>::UnitY()))
      .velocity(3 * uphill(), {0, 0, 0});
}

/// Returns the position (m) at time t of a ball that starts with a speed (m/s) and a spin (rad/s) on a floor
/// that moves at a constant speed. The ball slides until it rolls.
double sliding_ball(double speed, double spin, double floor_speed, double friction, double t) {
  const double slip = speed - kRadius * spin - floor_speed, a = (slip > 0 ? -1 : 1) * friction * kGravity,
               rolls = std::abs(slip) / (3.5 * friction * kGravity);
  return moved(speed, a, rolls) + (speed + a * rolls) * (t - rolls);
}

// A block on a spring: angular frequency (rad/s), coefficient of friction, and the displacement (m) at which
// the force of the spring equals the largest friction force.
constexpr double kFrequency = 10, kSpringFriction = 0.2;
constexpr double kStuck = kSpringFriction * kGravity / (kFrequency * kFrequency);
void on_spring(MultiBody& body, double x) {
  Part& b = block(body, x);
  body.spring("spring", point(b, 0, 0, 0), world(-2, 0, 0.05), kBlockMass * kFrequency * kFrequency, 0, 2);
}
/// Returns the position at time t of the block on the spring, if it starts at rest at x. The amplitude falls
/// by 2 kStuck in every half period.
Vec3<double> oscillator(double x, double t) {
  for (double sign = 1; std::abs(x) > kStuck && t > 0; sign = -sign) {
    const double swing = std::min(t, kPi / kFrequency);
    x = sign * kStuck + (x - sign * kStuck) * std::cos(kFrequency * swing);
    t -= swing;
  }
  return on_floor(x);
}
/// Returns the position at time t of the block on the spring and on a belt of speed 0.1 m/s. The block starts
/// at 3 kStuck, slides, sticks to the belt, and slides again.
Vec3<double> stick_slip(double t) {
  const double belt_speed = 0.1,
               sticks = (kPi + std::asin(belt_speed / (2 * kStuck * kFrequency))) / kFrequency,
               x = kStuck + 2 * kStuck * std::cos(kFrequency * sticks),
               slips = sticks + (kStuck - x) / belt_speed;
  return on_floor(kStuck + belt_speed / kFrequency * std::sin(kFrequency * (t - slips)));
}

/// Returns the zero of a function that changes its sign between two times.
template <class F>
double zero_of(F&& f, double low, double high) {
  const bool rises = f(high) > 0;
  for (int i = 0; i < 200; ++i) {
    const double middle = 0.5 * (low + high);
    ((f(middle) > 0) == rises ? high : low) = middle;
  }
  return low;
}
/// Returns the position (m) at time t of a block that starts with the speed v. The position of the belt is
/// amplitude sin(10 time), and the coefficient of friction is 0.3. If friction suffices, the block sticks
/// when it has the speed of the belt. It slips when the acceleration of the belt becomes too large.
double shaken(double amplitude, double v, double t) {
  const double w = 10, a_max = 0.3 * kGravity, step = 1e-4;
  auto speed = [&](double s) { return amplitude * w * std::cos(w * s); };
  auto acceleration = [&](double s) { return -amplitude * w * w * std::sin(w * s); };
  auto sufficient = [&](double s) { return a_max - std::abs(acceleration(s)); };
  double now = 0, x = 0;
  bool sticks = v == speed(0) && sufficient(0) > 0;
  while (now < t) {
    const double a = v - speed(now + 1e-9) > 0 ? -a_max : a_max, from = now, v_from = v;
    auto slip = [&](double s) { return v_from + a * (s - from) - speed(s); };
    auto ends = [&](double s) { return sticks ? sufficient(s) < 0 : slip(s) * slip(from + step) < 0; };
    double next = from + step;
    while (next < t && !ends(next)) next += step;
    const bool event = next < t;
    if (event) next = sticks ? zero_of(sufficient, next - step, next) : zero_of(slip, next - step, next);
    next = std::min(next, t);
    x += sticks ? amplitude * (std::sin(w * next) - std::sin(w * from)) : moved(v, a, next - from);
    v = sticks ? speed(next) : v + a * (next - from);
    if (event) sticks = !sticks && sufficient(next) >= 0;
    now = next;
  }
  return x;
}

/// Adds a plank on the floor and a box that slides on the plank at 2 m/s.
void box_on_plank(MultiBody& body, double floor_friction) {
  floor(body, 0.5);
  body.contact.pairs.push_back({"plank", "floor", true, floor_friction, {}});
  body.add<Primitive<Box>>("plank").rest({{"a1", 1}, {"a2", 0.2}, {"a3", 0.05}}).place({0, 0, 0.05});
  body.add<Primitive<Box>>("box")
      .rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.1}})
      .place({-0.5, 0, 0.2})
      .velocity({2, 0, 0}, {0, 0, 0});
}
/// Returns the position of the box at time t. The box slides on the plank until both have the same speed.
/// Then they move together; if the floor has friction, they have stopped at time t.
Vec3<double> box_at(double floor_friction, double t) {
  const double box = 0.4 * 0.4 * 0.2, plank = 2 * 0.4 * 0.1, a = 0.5 * kGravity,
               b = kGravity * (0.5 * box - floor_friction * (box + plank)) / plank, joint = 2 / (a + b),
               speed = b * joint,
               end = floor_friction > 0 ? stopped(speed, floor_friction * kGravity) : speed * (t - joint);
  return {-0.5 + moved(2, -a, joint) + end, 0, 0.2};
}

const std::vector<Problem>& problems() {
  static const std::vector<Problem> all{
      {"a block slides up a slope, stops and slides back", 1,
       [](MultiBody& body) { block_uphill(body, 0.3); },
       [] {
         const double up = -along_slope(-0.3), down = -along_slope(0.3), t = 3 / up;
         return on_slope(stopped(3, up) - moved(0, down, 1 - t), 0.05);
       }},
      {"a block slides up a slope and stays there", 1, [](MultiBody& body) { block_uphill(body, 0.7); },
       [] { return on_slope(stopped(3, -along_slope(-0.7)), 0.05); }},
      {"a block stops on a floor", 1,
       [](MultiBody& body) {
         floor(body, 0.5);
         block(body, 0, 2);
       },
       [] { return on_floor(stopped(2, 0.5 * kGravity)); }},
      {"a block is carried along by a belt of constant speed", 1,
       [](MultiBody& body) {
         belt(body, 0.3, "t");
         block(body);
       },
       [] { return on_floor(1 - stopped(1, 0.3 * kGravity)); }},
      {"a block slides against the motion of a belt and comes back", 1.5,
       [](MultiBody& body) {
         belt(body, 0.3, "-t");
         block(body, 0, 2);
       },
       [] {
         return on_floor(moved(2, -0.3 * kGravity, 3 / (0.3 * kGravity)) - (1.5 - 3 / (0.3 * kGravity)));
       }},
      {"a block slides on a shaken belt and sticks to it at times", 1,
       [](MultiBody& body) {
         belt(body, 0.3, "0.1 * sin(10 * t)");
         block(body, 0, 1);
       },
       [] { return on_floor(shaken(0.1, 1, 1)); }, false},
      {"a block slides on a belt that is shaken hard", 1,
       [](MultiBody& body) {
         belt(body, 0.3, "0.2 * sin(10 * t)");
         block(body);
       },
       [] { return on_floor(shaken(0.2, 0, 1)); }},
      {"a block sticks to a belt of growing acceleration until friction is too weak", 1,
       [](MultiBody& body) {
         belt(body, 0.3, "t^3");
         block(body);
       },
       [] {
         const double slips = 0.3 * kGravity / 6;  // the acceleration of the belt is 6 t
         return on_floor(std::pow(slips, 3) + moved(3 * slips * slips, 0.3 * kGravity, 1 - slips));
       },
       false},
      {"a block on a spring swings and sticks", 1.7,
       [](MultiBody& body) {
         floor(body, kSpringFriction);
         on_spring(body, 0.5);
       },
       [] { return oscillator(0.5, 1.7); }, false},
      {"a block on a spring slides on a belt, sticks to it and slides again", 0.9,
       [](MultiBody& body) {
         belt(body, kSpringFriction, "0.1 * t");
         on_spring(body, 3 * kStuck);
       },
       [] { return stick_slip(0.9); }, false},
      {"a block slides when a growing force exceeds friction", 1,
       [](MultiBody& body) {
         floor(body, 0.3);
         body.force("pull", point(block(body), 0, 0, 0), TimeVector(TimeFunction::formula("100 * t"), 0, 0));
       },
       [] {
         const double slips = 0.3 * kBlockMass * kGravity / 100;
         return on_floor(100 * std::pow(1 - slips, 3) / (6 * kBlockMass));
       },
       false},
      {"a block slides when gravity has turned by the angle of friction", 1,
       [](MultiBody& body) {
         floor(body, 0.5);
         block(body);
         body.changing_gravity =
             TimeVector(TimeFunction::formula("9.81 * sin(t)"), 0, TimeFunction::formula("-9.81 * cos(t)"));
       },
       [] {
         const double slips = std::atan(0.5), t = 1 - slips, c = std::cos(slips), s = std::sin(slips);
         return on_floor(kGravity * (s - std::sin(1) + c * t + 0.5 * (std::cos(1) - c + s * t)));
       },
       false},
      {"a box slides on a plank on ice until both have the same speed", 1,
       [](MultiBody& body) { box_on_plank(body, 0); }, [] { return box_at(0, 1); }, true, 1},
      {"a box slides on a plank on a floor, and both stop together", 1,
       [](MultiBody& body) { box_on_plank(body, 0.1); }, [] { return box_at(0.1, 1); }, true, 1},
      {"a ball slides and then rolls", 1,
       [](MultiBody& body) {
         floor(body, 0.2);
         ball(body, 1, 0);
       },
       [] { return ball_at(sliding_ball(1, 0, 0, 0.2, 1)); }},
      {"a ball with backspin comes back", 2,
       [](MultiBody& body) {
         floor(body, 0.2);
         ball(body, 1, -40);
       },
       [] { return ball_at(sliding_ball(1, -40, 0, 0.2, 2)); }},
      {"a ball with topspin accelerates until it rolls", 1,
       [](MultiBody& body) {
         floor(body, 0.2);
         ball(body, 0.5, 30);
       },
       [] { return ball_at(sliding_ball(0.5, 30, 0, 0.2, 1)); }},
      {"a ball on a belt slides and then rolls", 1,
       [](MultiBody& body) {
         belt(body, 0.2, "t");
         ball(body, 0, 0);
       },
       [] { return ball_at(sliding_ball(0, 0, 1, 0.2, 1)); }},
      {"a ball slides up a slope, then rolls up and back", 1,
       [](MultiBody& body) {
         slope(body, 0.3);
         body.add<Primitive<Sphere>>("ball")
             .rest({{"r", kRadius}})
             .place(on_slope(0, kRadius))
             .velocity(3 * uphill(), {0, 0, 0});
       },
       [] {
         const double slides = -along_slope(-0.3), rolls = 3 / -along_slope(-3.5 * 0.3);
         return on_slope(
             moved(3, -slides, rolls) + moved(3 - slides * rolls, 5.0 / 7 * along_slope(0), 1 - rolls),
             kRadius);
       }},
      {"a cylinder slides down a slope that is too steep to roll", 0.5,
       [](MultiBody& body) {
         slope(body, 0.1);
         cylinder(body, kRadius, 0.2).place(on_slope(0, kRadius), turned(-kPi / 2, Vec3<double>::UnitX()));
       },
       [] { return on_slope(moved(0, along_slope(0.1), 0.5), kRadius); }},
      {"a wheel rolls", 1,
       [](MultiBody& body) {
         floor(body, 0.5);
         cylinder(body, 0.3, 0.05)
             .place({0, 0, 0.3}, turned(-kPi / 2, Vec3<double>::UnitX()))
             .velocity({3, 0, 0}, {0, 0, 10});
       },
       [] { return Vec3<double>(3, 0, 0.3); }},
  };
  return all;
}

struct Run {
  double error;
  std::int64_t steps;
};
/// Runs a problem to its end. Returns the error of the position (m) and the number of steps.
Run run(const Problem& problem, const char* method, double tolerance) {
  MultiBody body;
  problem.scene(body);
  Simulation simulation(body, method, 1, tolerance);
  while (simulation.time() < problem.end) simulation.step_up_to(problem.end);
  const Vec3<double> x = simulation.state().q.segment<3>(7 * problem.part);
  return {(x - problem.exact()).norm(), simulation.step_counters().steps};
}

/// Adds a bar of 1 m on a hinge at its end, 0.02 m from a wall, at the angle 0.8 rad.
void hinged_bar(MultiBody& body) {
  body.contact.friction = 0.3;
  body.contact.restitution = 0.6;
  body.plane("wall", Vec3<double>(-0.02, 0, 0), {1, 0, 0});
  Part& bar = body.add<Primitive<Box>>("bar")
                  .rest({{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.5}})
                  .place({0.5 * std::sin(0.8), 0, -0.5 * std::cos(0.8)}, turned(-0.8, Vec3<double>::UnitY()));
  body.hinge("hinge", point(bar, material_towards({0, 0, 1})), world(0, 0, 0), Vec3<double>::UnitY());
}
/// Returns the angular velocity of the bar (rad/s) at time t: it swings until it hits the wall, and rebounds
/// with 0.6 of its angular velocity. The motion is integrated by RK4, with a last step that ends at the wall.
double exact_spin(double t) {
  const double inertia = 0.25 + (0.02 * 0.02 + 0.25) / 3;
  auto acceleration = [&](double angle) { return -0.5 * kGravity / inertia * std::sin(angle); };
  double angle = 0.8, rate = 0;
  auto advance = [&](double h) {
    const double k1 = rate, l1 = acceleration(angle), k2 = rate + 0.5 * h * l1,
                 l2 = acceleration(angle + 0.5 * h * k1), k3 = rate + 0.5 * h * l2,
                 l3 = acceleration(angle + 0.5 * h * k2), k4 = rate + h * l3,
                 l4 = acceleration(angle + h * k3);
    angle += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    rate += h / 6 * (l1 + 2 * l2 + 2 * l3 + l4);
  };
  const double step = 1e-4;
  double now = 0;
  while (angle + 2 * step * rate > 0) {
    advance(step);
    now += step;
  }
  for (int i = 0; i < 8; ++i) {  // Newton's method for the time of impact
    const double h = -angle / rate;
    advance(h);
    now += h;
  }
  rate *= -0.6;
  const int rest = 10000;
  const double h = (t - now) / rest;
  for (int i = 0; i < rest; ++i) advance(h);
  return -rate;  // the rotation about y decreases the angle
}

}  // namespace

TEST_CASE("errors of sliding that begins, stops or reverses fall with the tolerance",
          "[error][contact][long]") {
  for (const Problem& problem : problems())
    for (const char* method : {"dormand_prince", "dop853", "esdirk"})
      for (int digits = 4; digits <= (problem.constant_forces ? 10 : 8); ++digits) {
        const double tolerance = std::pow(10, -digits);
        const auto [error, steps] = run(problem, method, tolerance);
        CAPTURE(problem.name, method, tolerance, steps);
        CHECK(error < (problem.constant_forces ? 10 : 100) * tolerance);
      }
}

TEST_CASE("at fine tolerances errors of sliding under changing forces fall with the tolerance",
          "[error][contact][long]") {
  for (const Problem& problem : problems()) {
    if (problem.constant_forces) continue;
    CAPTURE(problem.name);
    CHECK(run(problem, "dop853", 1e-9).error < 1e-7);
    CHECK(run(problem, "dop853", 1e-10).error < 2e-8);
  }
}

TEST_CASE("a wheel rolls, and a block slides up a slope and back, in few steps", "[error][contact]") {
  CHECK(run(problems().back(), "dormand_prince", 1e-5).steps < 100);
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10})
    CHECK(run(problems().front(), "dormand_prince", tolerance).steps < 40);
}

TEST_CASE("a ball and an ellipsoid that slide, spin, roll and rock need less than 2500 steps a second",
          "[error][contact]") {
  for (const double tolerance : {1e-4, 1e-5}) {
    MultiBody body;
    floor(body, 0.2);
    body.contact.restitution = 0;
    ball(body, 1, 20);
    body.add<Primitive<Ellipsoid>>("egg")
        .rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}})
        .place({0, 1, 0.2})
        .velocity({0.5, 0.2, 0}, {1, 2, 6});
    Simulation simulation(body, "dormand_prince", 1, tolerance);
    while (simulation.time() < 1) simulation.step_up_to(1);
    CAPTURE(tolerance);
    CHECK(simulation.step_counters().steps < 2500);
  }
}

TEST_CASE("a hinged bar rebounds from a wall by its restitution, for any tolerance and step",
          "[error][contact]") {
  const double exact = exact_spin(0.75);
  for (const char* method : {"dormand_prince", "dop853", "esdirk"})
    for (int i = 0; i <= 28; ++i) {
      const double tolerance = std::pow(10, -3 - 0.25 * i);
      MultiBody body;
      hinged_bar(body);
      Simulation simulation(body, method, 1, tolerance);
      while (simulation.time() < 0.75) simulation.step_up_to(0.75);
      CAPTURE(method, tolerance, exact);
      CHECK(std::abs(simulation.state().v[4] - exact) < 100 * tolerance);
      CHECK(simulation.step_counters().steps < 1000);
    }
  for (const int steps : {150, 188, 200, 375, 750, 1500}) {
    MultiBody body;
    hinged_bar(body);
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.75, steps);
    CAPTURE(steps, exact);
    CHECK(std::abs(simulation.state().v[4] - exact) < 1e-4);
  }
}

}  // namespace friction_events_test
