// Runs to a tolerance that hardly advance: ProgressWatch finds them, and healthy runs have no report.
#include "catch.h"

#include <memory>
#include <optional>

#include "motion.h"

namespace slow_progress_test {

using namespace pliant;

namespace {

/// Adds n steps of equal length h (s) to a ProgressWatch, from the time t (s) on. Returns the last report.
/// interval: the whole time that the simulation is to advance, s. work: the counters of each step.
std::optional<SlowProgress> add_steps(ProgressWatch& watch, double& t, double h, long n, double interval,
                                      const StepCounters& work = {}) {
  std::optional<SlowProgress> report;
  for (long k = 0; k < n; ++k) {
    const std::optional<SlowProgress> found = watch.add(t, t + h, interval, work);
    if (found) report = found;
    t += h;
  }
  return report;
}

/// Returns the function value + rate t of the time t, s.
TimeFunction line(double value, double rate) {
  struct Line : TimeFunction::Impl {
    double value, rate;
    Taylor2<double> at(double t) const override { return {value + rate * t, rate, 0}; }
  };
  auto impl = std::make_shared<Line>();
  impl->value = value;
  impl->rate = rate;
  return TimeFunction(impl);
}

/// Adds a ball of 0.1 m to a body, at a height (m) and with an upward velocity (m/s), above a plane at z = 0.
void add_ball(MultiBody& body, double height, double velocity, double restitution) {
  Part& ball = body.add<Primitive<Sphere>>("ball", 1000);
  ball.rest({{"r", 0.1}}).place({0, 0, height}).velocity({0, 0, velocity}, {0, 0, 0});
  body.contact.restitution = restitution;
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}

}  // namespace

TEST_CASE(
    "many steps that advance by a tiny share of the requested time are reported, with their number and work",
    "[failure]") {
  ProgressWatch watch;
  double t = 0;
  StepCounters work;
  work.rejected = 1;
  work.impacts = 2;
  work.evaluations = 30;
  CHECK_FALSE(add_steps(watch, t, 1e-8, 1000, 1, work));
  const std::optional<SlowProgress> slow = add_steps(watch, t, 1e-10, 1000, 1, work);
  REQUIRE(slow);
  CHECK(slow->steps == 1000);
  CHECK(slow->rejected == 1000);
  CHECK(slow->impacts == 2000);
  CHECK(slow->evaluations == 30000);
  CHECK(std::abs(slow->advance - 1e-7) <= 1e-12);
}

TEST_CASE("a step that does not begin at the end of the last step begins a new count", "[failure]") {
  ProgressWatch watch;
  double t = 0;
  CHECK_FALSE(add_steps(watch, t, 1e-10, 999, 1));
  t = 0;
  CHECK_FALSE(add_steps(watch, t, 1e-10, 999, 1));
  CHECK(add_steps(watch, t, 1e-10, 1, 1));
}

TEST_CASE("a step with very many evaluations is reported alone", "[failure]") {
  ProgressWatch watch;
  double t = 0;
  StepCounters work;
  work.evaluations = ProgressWatch::kMaxEvaluations;
  CHECK_FALSE(add_steps(watch, t, 0.1, 1, 1, work));
  ++work.evaluations;
  CHECK(add_steps(watch, t, 0.1, 1, 1, work));
}

TEST_CASE("impacts that follow each other ever faster are reported with the part and the time", "[failure]") {
  // The ball bounces without loss between the floor and a plane that approaches the floor, and is faster
  // after each impact. After 1 s the distance of the two planes is the diameter of the ball.
  MultiBody body;
  body.gravity.setZero();
  add_ball(body, 0.6, 1, 1);
  body.plane("press", TimeVector(0, 0, line(1.2, -1)), {0, 0, -1});
  Simulation simulation(body, "dormand_prince", 1, 1e-6);
  while (simulation.time() < 0.9999999 && !simulation.slow_progress()) simulation.step_up_to(10);
  REQUIRE(simulation.slow_progress());
  const SlowProgress& slow = *simulation.slow_progress();
  CAPTURE(slow.time, slow.advance, slow.impacts, slow.fastest);
  CHECK(slow.impacts >= 500);
  CHECK(slow.time > 0.9);
  CHECK(slow.fastest.find("part 'ball'") != std::string::npos);
}

TEST_CASE("a ball that bounces until it rests is not reported", "[failure]") {
  MultiBody body;
  add_ball(body, 0.5, 0, 0.8);
  Simulation simulation(body, "dormand_prince", 1, 1e-6);
  while (simulation.time() < 5) simulation.step_up_to(5);
  CHECK_FALSE(simulation.slow_progress());
}

}  // namespace slow_progress_test
