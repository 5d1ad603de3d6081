// Run time against error, integrators side by side: the free top (its closed form, physics of Landau &
// Lifshitz section 37) and a tumbling solid with every parameter dynamic (against RK4 at a sixteenth of the
// smallest step). CSV to standard output; bench/plot.py draws it.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>

#include <pliant/pliant.h>

using namespace pliant;

namespace {

struct Problem {
  const char* name;
  double end;
  std::function<void(MultiBody&)> build;
  std::function<double(Simulation&)> error;
};

struct Outcome {
  double seconds, error, balance;
  long evaluations;
};

Outcome run(const Problem& problem, const std::string& method, double h) {
  MultiBody body;
  body.gravity.setZero();
  problem.build(body);
  Simulation simulation(body, method);
  const long steps = std::lround(problem.end / h);
  const auto start = std::chrono::steady_clock::now();
  for (long i = 0; i < steps; ++i) simulation.step(problem.end / static_cast<double>(steps));
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return {seconds, problem.error(simulation), std::abs(simulation.ledger().balance),
          simulation.step_counters().evaluations};
}

void top(MultiBody& body) {
  auto& part = body.add<Primitive<Ellipsoid>>("top");
  part.rest({{"a1", std::sqrt(1.75)}, {"a2", std::sqrt(0.75)}, {"a3", 0.5}});
  part.mass(5).move({0, 0, 0}, {1, 0, 1.2});
}
double top_error(Simulation& simulation) {
  const Vec3<double> exact(0.9646371098, -0.3228201816, 1.1766137016);  // omega(10), ten digits
  return (simulation.state().v.segment<3>(3) - exact).norm();
}

void tumbling(MultiBody& body) {
  auto& part = body.add<Primitive<Superellipsoid, Chain<Taper, Twist, Bend>>>("solid");
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.5}, {"taper.tx", 0.2}});
  part.stiffness({{"a1", 3e4},
                  {"a2", 3e4},
                  {"a3", 3e4},
                  {"taper.tx", 1e3},
                  {"taper.ty", 1e3},
                  {"twist.angle", 500},
                  {"bend.angle", 500}});
  part.initial({{"a1", 0.32}, {"twist.angle", 0.3}, {"bend.angle", 0.2}}).move({1, 2, 3}, {2, 3, 1});
}

}  // namespace

int main() {
  constexpr double kTumblingSmallest = 0.00025;
  MultiBody body;
  body.gravity.setZero();
  tumbling(body);
  Simulation truth(body, "rk4");
  const double end = 0.4, h = kTumblingSmallest / 16;
  for (long i = 0; i < std::lround(end / h); ++i) truth.step(h);
  const State exact = truth.state();

  const Problem problems[] = {
      {"free top", 10, top, top_error},
      {"tumbling solid", end, tumbling,
       [&exact](Simulation& simulation) { return (simulation.state().q - exact.q).norm() / exact.q.norm(); }},
  };
  std::printf("problem,method,step_s,evaluations,cpu_ms,error,balance_J\n");
  for (const Problem& problem : problems)
    for (const IntegratorInfo& method : all_integrators())
      for (int halvings = 0; halvings < 8; ++halvings) {
        const double step = (problem.end == end ? 128 * kTumblingSmallest / 4 : 0.16) / (1 << halvings);
        const Outcome outcome = run(problem, method.name, step);
        std::printf("%s,%s,%g,%ld,%.4f,%.3e,%.3e\n", problem.name, method.name, step, outcome.evaluations,
                    outcome.seconds * 1e3, outcome.error, outcome.balance);
        std::fflush(stdout);
      }
}
