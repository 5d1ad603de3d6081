// Events other than impacts and forces that wake sleeping bodies: prescribed motion of a part or of the end
// of a string, planes that appear, and plates that appear or disappear. Prescribed motion elsewhere does not
// wake a sleeping body.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <pliant/body/joints/string.h>

#include "motion.h"

namespace stress_sleep_test {

using namespace pliant;

namespace {

constexpr double kStep = 2e-3;  // s

Part& cube(MultiBody& body, const std::string& name, const Vec3<double>& at) {
  return test::add(body, name, "box", {}, 500).rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place(at);
}
/// Adds a tower of two cubes without a floor, and activates sleep.
void tower(MultiBody& body) {
  body.contact.sleep = Sleep{1e-3, 0.1};
  body.contact.active = true;
  for (int i = 0; i < 2; ++i) cube(body, "cube" + std::to_string(i), {0.01 * i, 0, 0.1 + 0.2 * i});
}
void floor(MultiBody& body) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
/// Adds a box of the given half lengths with prescribed motion.
Part& add_moving_box(MultiBody& body, const Vec3<double>& half, TimeVector position) {
  PrescribedMotion motion;
  motion.position = std::move(position);
  return test::add(body, "hand", "box", {}, 500)
      .rest({{"a1", half[0]}, {"a2", half[1]}, {"a3", half[2]}})
      .prescribe(motion);
}
/// Returns from + scale max(t - 0.5 s, 0).
TimeFunction ramp_at_half(const std::string& scale, const std::string& from) {
  return TimeFunction::formula(from + " + " + scale + " * max(t - 0.5, 0)");
}
/// Returns whether both cubes are awake at 0.54 s. Requires that they sleep at 0.3 s and do not move until
/// 0.498 s.
bool wakes_at_half(MultiBody& body) {
  Simulation simulation(body, "rk4");
  while (simulation.time() < 0.3) simulation.step(kStep);
  const State asleep = simulation.state();
  REQUIRE((sleeps(asleep, 0) && sleeps(asleep, 1)));
  while (simulation.time() < 0.497) simulation.step(kStep);
  REQUIRE(simulation.state().q.head<14>() == asleep.q.head<14>());
  while (simulation.time() < 0.54) simulation.step(kStep);
  return !sleeps(simulation.state(), 0) && !sleeps(simulation.state(), 1);
}

}  // namespace

TEST_CASE(
    "parts with prescribed motion, planes, plates and strings wake sleeping bodies that they touch, leave or "
    "pull",
    "[sleep][contact]") {
  MultiBody body;
  SECTION("a paddle that approaches") {
    tower(body);
    floor(body);
    // The paddle touches the upper cube at 0.51 s.
    add_moving_box(body, {0.05, 0.2, 0.05}, TimeVector(ramp_at_half("1", "-0.15"), 0, 0.3));
    CHECK(wakes_at_half(body));
  }
  SECTION("a plane that appears inside them") {
    tower(body);
    floor(body);
    body.plane("wall", Vec3<double>(-0.05, 0, 0), {1, 0, 0}).on = 0.5;
    CHECK(wakes_at_half(body));
  }
  SECTION("a plate under them that is removed") {
    tower(body);
    body.plate("table", {0, 0, 0}, Eigen::Quaterniond::Identity(), 1, 1).off = 0.5;
    CHECK(wakes_at_half(body));
  }
  SECTION("a plate that appears inside them") {
    tower(body);
    floor(body);
    body.plate("shelf", {0, 0, 0.25}, Eigen::Quaterniond::Identity(), 1, 1).on = 0.5;
    CHECK(wakes_at_half(body));
  }
  SECTION("the end of a taut string that starts to move") {
    tower(body);
    floor(body);
    body.join("string", String{0.3},
              {point(*body.parts()[1], 0, 0), world(TimeVector(ramp_at_half("0.5", "0.41"), 0, 0.3))});
    CHECK(wakes_at_half(body));
  }
}

TEST_CASE("bodies on a part with prescribed motion do not sleep", "[sleep][contact]") {
  MultiBody body;
  tower(body);
  add_moving_box(body, {1, 1, 0.05}, TimeVector(ramp_at_half("0.5", "0"), 0, -0.05));
  Simulation simulation(body, "rk4");
  while (simulation.time() < 0.6) {
    simulation.step(kStep);
    REQUIRE((!sleeps(simulation.state(), 0) && !sleeps(simulation.state(), 1)));
  }
  CHECK(simulation.state().q[0] > 0.02);  // friction drags the cube along
}

TEST_CASE("prescribed motion elsewhere does not wake bodies", "[sleep][contact]") {
  for (const bool plane : {false, true}) {
    MultiBody body;
    tower(body);
    floor(body);
    if (plane)
      body.plane("wall", TimeVector(ramp_at_half("1", "-3"), 0, 0), {1, 0, 0});
    else
      add_moving_box(body, {0.05, 0.2, 0.05}, TimeVector(ramp_at_half("1", "-0.9"), 0, 0.3));
    Simulation simulation(body, "rk4");
    while (simulation.time() < 0.3) simulation.step(kStep);
    const State asleep = simulation.state();
    CAPTURE(plane);
    REQUIRE((sleeps(asleep, 0) && sleeps(asleep, 1)));
    while (simulation.time() < 0.8) simulation.step(kStep);  // the distance stays above 0.4 m
    CHECK((sleeps(simulation.state(), 0) && sleeps(simulation.state(), 1)));
    CHECK(simulation.state().q == asleep.q);
  }
}

}  // namespace stress_sleep_test
