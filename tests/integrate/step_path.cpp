// What is known between the ends of a step: its order of every method, and what it takes.
#include "catch.h"

#include <functional>

#include <pliant/integrate/dop853.h>
#include <pliant/integrate/dormand_prince.h>
#include <pliant/integrate/rk4.h>

#include "motion.h"

namespace step_path_test {

using namespace pliant;

namespace {

void stretching_link(MultiBody& body) {
  Part& link = body.add<Primitive<Ellipsoid>>("link");
  link.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).stiffness({{"a1", 2e4}, {"a2", 2e4}, {"a3", 2e4}});
  link.place({0.3, 0, 0}).move({0, 0.6, 0}, {0, 0, 2});
  body.ball("joint", world(0, 0, 0), point(link, 0, kPi));
}

/// What a path errs by at some of its places, of q and v together, over one step from the start.
struct Errors {
  double q = 0, v = 0;
};
Errors errors_of(const std::function<void(MultiBody&)>& build, Integrator& method, double h, long* taken) {
  MultiBody body;
  build(body);
  Simulation simulation(body, "rk4");
  const State low = simulation.state();
  State high = low;
  high.h = h;
  Workspace<double> work;
  StepCounters counters;
  method.step(simulation.dynamics(), high, work, counters);
  const long before = counters.evaluations;
  const StepPath path = method.path(simulation.dynamics(), low, h, high, counters);
  *taken = counters.evaluations - before;
  VecX<double> q, v;
  path.at(0, q);
  path.velocities_at(0, v);
  CHECK((q - low.q).norm() < 1e-15);
  CHECK((v - low.v).norm() == 0);
  path.at(1, q);
  path.velocities_at(1, v);
  CHECK((q - high.q).norm() < 1e-14);
  CHECK((v - high.v).norm() < 1e-14 * (1 + high.v.norm()));
  Errors worst;
  for (const double x : {0.25, 0.6, 0.85}) {
    MultiBody again;
    build(again);
    Simulation exact(again, "dop853");
    test::run(exact, x * h, 16);
    path.at(x, q);
    path.velocities_at(x, v);
    worst.q = std::max(worst.q, (q - exact.state().q).norm());
    worst.v = std::max(worst.v, (v - exact.state().v).norm());
  }
  return worst;
}

}  // namespace

TEST_CASE("a step is known in between to the order of its method's path", "[path]") {
  struct Case {
    std::unique_ptr<Integrator> method;
    double q_order, v_order, h;
    long evaluations;
  };
  // Without a tolerance dormand_prince has no rates at the end of a step yet.
  std::vector<Case> cases;
  cases.push_back({std::make_unique<Dop853>(), 8, 8, 0.02, 4});
  cases.push_back({std::make_unique<DormandPrince>(), 5, 5, 0.005, 1});
  cases.push_back({std::make_unique<Rk4>(), 4, 2, 0.005, 0});
  for (const auto& build : {std::function<void(MultiBody&)>(stretching_link),
                            std::function<void(MultiBody&)>([](MultiBody& b) { test::tumbling_solid(b); })}) {
    for (const Case& of : cases) {
      std::vector<double> q, v;
      for (int halving = 0; halving < 3; ++halving) {
        long taken = -1;
        const Errors errors = errors_of(build, *of.method, of.h / (1 << halving), &taken);
        CHECK(taken == of.evaluations);
        q.push_back(errors.q);
        v.push_back(errors.v);
      }
      CAPTURE(of.method->name(), q, v);
      CHECK(test::observed_order(q) > of.q_order - 0.5);
      CHECK(test::observed_order(v) > of.v_order - 0.5);
    }
  }
}

}  // namespace step_path_test
