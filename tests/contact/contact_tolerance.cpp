// The tolerance of contact (ContactSettings::tolerance): violations of the laws of contact and remaining
// overlaps are within the tolerance, errors fall with the tolerance, and looser tolerances need fewer
// sweeps (iterations over all contacts).
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/contact/contact_stepping.h>

#include "motion.h"

namespace contact_tolerance_test {

using namespace pliant;

namespace {

constexpr double kHalf = 0.1, kStep = 2e-3;  // m, s

/// Adds a pyramid of boxes, or of balls that touch, on a floor. speed: downward speed of all parts, m/s.
void pyramid(MultiBody& body, int rows, const char* shape, double speed = 1) {
  const bool balls = std::string(shape) == "sphere";
  const double apart = balls ? 2 : 2.1, above = balls ? std::sqrt(3.0) : 2;  // in half sizes
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < rows - row; ++k) {
      Part& part = body.add(make_part(std::to_string(row) + "_" + std::to_string(k), shape, {}, 1000));
      if (balls)
        part.rest({{"r", kHalf}});
      else
        part.rest({{"a1", kHalf}, {"a2", kHalf}, {"a3", kHalf}});
      part.place({kHalf * apart * (k + 0.5 * row), 0, kHalf * (above * row + 1)});
      part.velocity({0, 0, -speed}, {0, 0, 0});
    }
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  body.contact.friction = 0.6;
  body.contact.restitution = balls ? 0 : 0.3;
}

/// Coordinates and counters at the end of a run.
struct Outcome {
  VecX<double> q;
  StepCounters counters;
};

/// Simulates the fall of a pyramid of this shape for 0.03 s, with a tolerance of contact.
Outcome outcome(const char* shape, const std::optional<double>& tolerance) {
  MultiBody body;
  pyramid(body, 6, shape);
  body.contact.tolerance = tolerance;
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.03, 15);
  return {simulation.state().q, simulation.step_counters()};
}

}  // namespace

TEST_CASE("errors of contact follow the tolerance of contact", "[contact]") {
  const Outcome exact = outcome("box", std::nullopt);
  CHECK(exact.counters.worst_residual.is_allowed());
  auto error = [&](const Outcome& rough) { return (rough.q - exact.q).lpNorm<Eigen::Infinity>(); };
  double last_error = error(outcome("box", 0.1));
  CHECK(last_error > 1e-4 * kHalf);
  for (const double tolerance : {1e-2, 1e-4, 1e-8, 1e-10}) {
    CAPTURE(tolerance);
    const Outcome rough = outcome("box", tolerance);
    CHECK(rough.counters.worst_residual.is_allowed());
    CHECK(rough.counters.worst_overlap.is_allowed());
    // 1 + 9.81 kStep is the largest possible speed of the first impact, m/s.
    CHECK(rough.counters.contact_residual <= tolerance * (1 + 9.81 * kStep));
    CHECK(rough.counters.contact_overlap <= 1e-3 * tolerance * kHalf + 1e-10 * kHalf);
    CHECK(error(rough) < tolerance * kHalf);
    CHECK(error(rough) < 0.1 * last_error);
    last_error = error(rough);
  }
}

TEST_CASE("looser tolerances of contact need fewer sweeps", "[contact]") {
  const long exact = outcome("sphere", std::nullopt).counters.contact_sweeps;
  CHECK(3 * outcome("sphere", 1e-2).counters.contact_sweeps < 2 * exact);
}

TEST_CASE("with a tolerance of contact, a pile at rest stays at rest, in at most as many sweeps as without",
          "[contact]") {
  auto rest = [](const std::optional<double>& tolerance) {
    MultiBody body;
    pyramid(body, 6, "box", 0);
    body.contact.tolerance = tolerance;
    Simulation simulation(body, "rk4");
    const VecX<double> q = simulation.state().q;
    test::run(simulation, 0.4, 200);
    CHECK((simulation.state().q - q).lpNorm<Eigen::Infinity>() <
          (1e-3 * tolerance.value_or(0) + 1e-12) * kHalf);  // an overlap that may remain
    CHECK(simulation.state().v.lpNorm<Eigen::Infinity>() < 1e-10);
    return simulation.step_counters().contact_sweeps;
  };
  CHECK(rest(1e-3) <= rest(std::nullopt));
}

TEST_CASE("a tolerance of contact that is out of range is refused", "[contact]") {
  for (const double tolerance : {0.0, -1e-3, 1e-15, 0.11, std::numeric_limits<double>::quiet_NaN(),
                                 std::numeric_limits<double>::infinity()}) {
    CAPTURE(tolerance);
    MultiBody body;
    pyramid(body, 1, "box");
    body.contact.tolerance = tolerance;
    CHECK_THROWS_WITH(Simulation(body, "rk4"),
                      Catch::Contains("contact: the tolerance is") && Catch::Contains("from 1e-14 to 0.1"));
  }
}

TEST_CASE("a violation that no impulse prevents exceeds the tolerance, and its time is recorded",
          "[contact]") {
  // A joint presses a ball through the floor with a constant speed from the time 0.2 s on.
  double last_limit = 0;  // limit of the overlap for the previous tolerance, m
  for (const std::optional<double>& tolerance :
       {std::optional<double>(), std::optional<double>(1e-5), std::optional<double>(0.1)}) {
    MultiBody body;
    body.contact.tolerance = tolerance;
    Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
    ball.rest({{"r", kHalf}}).place({0, 0, 2 * kHalf});
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    body.ball("pull", point(ball, 0, 0, 0), world(TimeVector(0, 0, TimeFunction::formula("0.2 - 0.5 * t"))));
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.3, 150);
    const StepCounters& counters = simulation.step_counters();
    CHECK(counters.contact_residual == Approx(0.5));
    CHECK(counters.contact_overlap == Approx(0.05).margin(1e-3));
    CHECK_FALSE(counters.worst_residual.is_allowed());
    CHECK(counters.worst_residual.value == Approx(0.5));
    CHECK(counters.worst_residual.tolerance == Approx(0.5 * tolerance.value_or(1e-3)));
    CHECK(counters.worst_residual.time == Approx(0.2).margin(2 * kStep));
    CHECK_FALSE(counters.worst_overlap.is_allowed());
    CHECK(counters.worst_overlap.value == Approx(0.05).margin(1e-3));
    CHECK(counters.worst_overlap.time == Approx(0.3));
    CHECK(counters.worst_overlap.tolerance >= last_limit);  // a larger tolerance does not lower the limit
    last_limit = counters.worst_overlap.tolerance;
  }
}

}  // namespace contact_tolerance_test
