// Contact with planes that are active for a short time, and with planes and parts that move to and fro within
// a step. The order in which two parts are added does not matter. A small part deep in a large part is
// separated slowly.
// N54 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <pliant/part/local/local_laws.h>

#include "motion.h"

namespace passing_things_test {

using namespace pliant;

namespace {

Part& ball(MultiBody& body, double r, const Vec3<double>& at) {
  return body.add<Primitive<Sphere>>("ball").rest({{"r", r}}).place(at);
}

void make_soft(Part& part) {
  part.make_shell();
  LocalSettings settings;
  settings.resolution = 2;
  settings.alpha = 2;
  settings.energies = {local_law("membrane", {1e5, 0.3, 0.01})};
  part.deform_locally(settings);
}

/// Adds a plane, and a ball that reaches the plane after 0.5 s. If the plane is active at this time, the ball
/// rebounds elastically. The plane is active from `on` to `off` (s).
void ball_before_plane(MultiBody& body, double on, double off) {
  body.gravity.setZero();
  ball(body, 0.1, {0, 0, 0.6}).velocity({0, 0, -1}, {0, 0, 0});
  body.contact.active = true;
  body.contact.restitution = 1;
  ContactPlane& plane = body.contact.planes.emplace_back();
  plane.name = "trap";
  plane.on = on;
  plane.off = off;
}

}  // namespace

TEST_CASE("a plane acts on parts that reach it before it is switched off", "[contact]") {
  for (const auto& [method, tolerance] : {std::pair{"dop853", 1e-6}, std::pair{"rk4", 0.0}}) {
    for (const double off : {0.45, 0.55}) {
      MultiBody body;
      ball_before_plane(body, 0, off);
      Simulation simulation(body, method, 1, tolerance);
      if (tolerance > 0)
        while (simulation.time() < 1) simulation.step_up_to(1);
      else
        test::run(simulation, 1, 7);
      CAPTURE(method, off);
      CHECK(simulation.state().q[2] == Approx(off > 0.5 ? 0.6 : -0.4).margin(1e-12));
    }
  }
}

TEST_CASE("a plane that is active for less than a step is hit within the step", "[contact]") {
  MultiBody body;
  ball_before_plane(body, 0.4997, 0.5003);
  Simulation simulation(body, "rk4");
  test::run(simulation, 1, 500);
  CHECK(simulation.state().q[2] == Approx(0.6).margin(1e-12));
}

TEST_CASE("a paddle that returns, or moves across, within a step hits the part in between", "[contact]") {
  for (const char* formula : {"0.5 * cos(100 * pi * t)", "0.5 * cos(200 * pi * t)"})
    for (const bool soft : {false, true}) {
      MultiBody body;
      body.gravity.setZero();
      Part& target = body.add<Primitive<Ellipsoid>>("target");
      target.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}});
      if (soft) make_soft(target);
      PrescribedMotion motion;
      motion.position = TimeVector(TimeFunction::formula(formula), 0, 0);
      body.add<Primitive<Box>>("paddle").rest({{"a1", 0.05}, {"a2", 0.3}, {"a3", 0.3}}).prescribe(motion);
      body.contact.active = true;
      Simulation simulation(body, "semi_implicit_euler");
      simulation.step(0.01);
      CAPTURE(formula, soft);
      CHECK(simulation.model().position(simulation.state(), 0)[0] < -0.3);
    }
}

TEST_CASE("a plane that oscillates within a step hits the part in its way", "[contact]") {
  for (const bool soft : {false, true}) {
    MultiBody body;
    body.gravity.setZero();
    Part& target = body.add<Primitive<Sphere>>("target");
    target.rest({{"r", 0.1}}).place({0, 0, 0.3});
    if (soft) make_soft(target);
    body.contact.active = true;
    ContactPlane& plane = body.contact.planes.emplace_back();
    plane.name = "piston";
    plane.point = TimeVector(0, 0, TimeFunction::formula("0.2 - 0.2 * cos(200 * pi * t)"));
    Simulation simulation(body, "semi_implicit_euler");
    simulation.step(0.01);
    CAPTURE(soft);
    CHECK(simulation.model().position(simulation.state(), 0)[2] > 0.4);
  }
}

TEST_CASE("a box rebounds equally from a table that was added first or last", "[contact]") {
  auto height = [](bool table_first) {
    MultiBody body;
    auto add_table = [&] {
      body.add<Primitive<Box>>("table")
          .rest({{"a1", 1.1}, {"a2", 1.1}, {"a3", 0.1}})
          .place({0, 0, -0.1})
          .fix();
    };
    if (table_first) add_table();
    body.add<Primitive<Box>>("box")
        .rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}})
        .place({0, 0, 0.2}, Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Vec3<double>::UnitY())));
    if (!table_first) add_table();
    body.contact.active = true;
    body.contact.restitution = 0.8;
    Simulation simulation(body, "rk4");
    double highest = 0;
    for (int i = 0; i < 250; ++i) {
      simulation.step(2e-3);
      if (simulation.time() > 0.2)
        highest = std::max(highest, simulation.model().position(simulation.state(), table_first ? 1 : 0)[2]);
    }
    return highest;
  };
  const double first = height(true), last = height(false);
  CHECK(last > 0.12);
  CHECK(first == Approx(last).epsilon(0.02));
}

TEST_CASE("N54: a small part deep in a much larger one is separated by one size of the small part per second",
          "[contact]") {
  for (const bool ground_first : {false, true}) {
    MultiBody body;
    body.gravity.setZero();
    auto add_ground = [&] {
      body.add<Primitive<Box>>("ground")
          .rest({{"a1", 500}, {"a2", 500}, {"a3", 500}})
          .place({0, 0, -500})
          .fix();
    };
    if (ground_first) add_ground();
    ball(body, 5e-3, {0, 0, 1e-3});
    if (!ground_first) add_ground();
    body.contact.active = true;
    Simulation simulation(body, "rk4");
    const double start = simulation.state().q[2];
    simulation.step(2e-3);
    CAPTURE(ground_first);
    CHECK(simulation.state().q[2] - start > 0);
    CHECK(simulation.state().q[2] - start <= 5e-3 * 2e-3 * 1.001);
  }
}

}  // namespace passing_things_test
