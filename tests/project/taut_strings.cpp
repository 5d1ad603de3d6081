// Taut strings and contacts that act at the same instant.
#include "catch.h"

#include <cmath>

#include <pliant/body/joints/all_joints.h>
#include <pliant/contact/contact_stepping.h>

#include "motion.h"

namespace taut_strings_test {

using namespace pliant;

namespace {

constexpr double kG = 9.81;  // m/s^2

Part& ball(MultiBody& body, const char* name, const Vec3<double>& at) {
  return body.add(make_part(name, "sphere", {}, 1000)).rest({{"r", 0.1}}).place(at);
}
Point centre(Part& part) {
  return point(part, 0, 0, 0);
}
/// Returns the impulse (N s) on the first joint of the model in the step of the first impact; NaN if there is
/// no impact within 1 s.
double impulse_of_impact(Simulation& simulation) {
  for (int i = 0; i < 1000; ++i) {
    simulation.step(1e-3);
    if (simulation.step_counters().impacts > 0) return simulation.contact()->record().joint_impulses[0];
  }
  return std::nan("");
}

}  // namespace

TEST_CASE("a ball on a taut string does not move when another ball falls on it", "[contact][joints]") {
  for (const char* method : {"rk4", "dormand_prince"}) {
    MultiBody body;
    body.contact.active = true;
    Part& hung = ball(body, "hung", {0, 0, 0});
    Part& falls = ball(body, "falls", {0, 0, 0.4});
    body.join("string", String{1}, {world(0, 0, 1), centre(hung)});
    Simulation simulation(body, method);
    const double impulse = impulse_of_impact(simulation);
    const double v = std::sqrt(2 * kG * 0.2);
    // Time from the impact to the end of the step. In this time the string carries both balls.
    const double left = simulation.time() - v / kG;
    REQUIRE((left >= 0 && left <= 1e-3));
    CHECK(impulse == Approx(falls.total_mass() * v).epsilon(0.02));
    CHECK(impulse >= falls.total_mass() * v * (1 - 1e-9));
    CHECK(std::abs(simulation.state().v[2]) < 1e-9);
    CHECK(std::abs(simulation.state().v[8]) < 1e-9);
    CHECK(simulation.state().q[2] == Approx(0).margin(1e-12));
  }
}

TEST_CASE("a slack string receives no impulse from an impact", "[contact][joints]") {
  MultiBody body;
  body.contact.active = true;
  body.gravity.setZero();
  Part& hung = ball(body, "hung", {0, 0, 0});
  ball(body, "falls", {0, 0, 0.4}).velocity({0, 0, -2}, {0, 0, 0});
  body.join("string", String{1.2}, {world(0, 0, 1), centre(hung)});
  Simulation simulation(body, "rk4");
  CHECK(impulse_of_impact(simulation) == 0);
  CHECK(simulation.state().v[2] == Approx(-1).epsilon(1e-10));
  CHECK(simulation.state().v[8] == Approx(-1).epsilon(1e-10));
}

TEST_CASE("a taut string with a moving anchor transmits the anchor's speed in an impact",
          "[contact][joints]") {
  // The anchor and the pulled ball rise at 1 m/s. The pulled ball hits another ball from below, which then
  // rises at this speed.
  MultiBody body;
  body.contact.active = true;
  body.gravity.setZero();
  Part& pulled = ball(body, "pulled", {0, 0, 0}).velocity({0, 0, 1}, {0, 0, 0});
  Part& still = ball(body, "still", {0, 0, 0.4});
  body.join("string", String{1}, {world(TimeVector(0, 0, TimeFunction::formula("1 + t"))), centre(pulled)});
  Simulation simulation(body, "rk4");
  const double impulse = impulse_of_impact(simulation);
  CHECK(simulation.state().v[2] == Approx(1).epsilon(1e-9));
  CHECK(simulation.state().v[8] == Approx(1).epsilon(1e-9));
  CHECK(impulse == Approx(still.total_mass()).epsilon(1e-6));
}

}  // namespace taut_strings_test
