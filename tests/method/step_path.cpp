// Interpolation within a step: its order for every method, and its cost in evaluations.
#include "catch.h"

#include <functional>

#include <pliant/method/dop853.h>
#include <pliant/method/dormand_prince.h>
#include <pliant/method/rk4.h>

#include "motion.h"

namespace step_path_test {

using namespace pliant;

namespace {

void stretching_link(MultiBody& body) {
  Part& link = body.add<Primitive<Ellipsoid>>("link");
  link.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).stiffness({{"a1", 2e4}, {"a2", 2e4}, {"a3", 2e4}});
  link.place({0.3, 0, 0}).velocity({0, 0.6, 0}, {0, 0, 2});
  body.ball("joint", world(0, 0, 0), point(link, 0, kPi));
}

/// Returns the largest error of the path (the coordinates within a step) at three times within the first
/// step, of length h. controlled: whether the method also measures the error of the step. `evaluations`
/// receives the number of additional evaluations that the path needs.
double error_of(const std::function<void(MultiBody&)>& build, Integrator& method, bool controlled, double h,
                long* evaluations) {
  MultiBody body;
  build(body);
  Simulation simulation(body, "rk4");
  const ErrorScale scale(simulation.model(), 1);
  method.measure(controlled ? &scale : nullptr);
  const State low = simulation.state();
  State high = low;
  high.h = h;
  Workspace<double> work;
  StepCounters counters;
  StepContext step(simulation.dynamics(), high, work, counters);
  method.step(step);
  method.measure(nullptr);
  const long before = counters.evaluations;
  const StepPath path = method.path(simulation.dynamics(), low, h, high, counters);
  *evaluations = counters.evaluations - before;
  VecX<double> q;
  path.at(0, q);
  CHECK((q - low.q).norm() < 1e-15);
  path.at(1, q);
  CHECK((q - high.q).norm() < 1e-14);
  double worst = 0;
  for (const double x : {0.25, 0.6, 0.85}) {
    MultiBody again;
    build(again);
    Simulation exact(again, "dop853");
    test::run(exact, x * h, 16);
    path.at(x, q);
    worst = std::max(worst, (q - exact.state().q).norm());
  }
  return worst;
}

}  // namespace

TEST_CASE("the interpolation within a step has the order of the dense output of its method", "[path][long]") {
  struct Case {
    std::unique_ptr<Integrator> method;
    bool controlled;
    /// `order`: order of the error of the path within one step. `h`: length of the longest step, s.
    double order, h;
    long evaluations;  ///< additional evaluations of the path
  };
  std::vector<Case> cases;
  cases.push_back({std::make_unique<Dop853>(), false, 8, 0.02, 4});
  cases.push_back({std::make_unique<Dop853>(), true, 8, 0.02, 4});
  cases.push_back({std::make_unique<DormandPrince>(), false, 5, 0.005, 1});
  cases.push_back({std::make_unique<DormandPrince>(), true, 5, 0.005, 0});
  cases.push_back({std::make_unique<Rk4>(), false, 4, 0.005, 0});
  for (const auto& build : {std::function<void(MultiBody&)>(stretching_link),
                            std::function<void(MultiBody&)>([](MultiBody& b) { test::tumbling_solid(b); })}) {
    for (const Case& tested : cases) {
      std::vector<double> errors;
      for (int halving = 0; halving < 3; ++halving) {
        long evaluations = -1;
        errors.push_back(
            error_of(build, *tested.method, tested.controlled, tested.h / (1 << halving), &evaluations));
        CHECK(evaluations == tested.evaluations);
      }
      CAPTURE(tested.method->name(), tested.controlled, errors);
      CHECK(test::observed_order(errors) > tested.order - 0.5);
    }
  }
}

}  // namespace step_path_test
