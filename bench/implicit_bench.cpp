// Measures the linearly implicit method on solids. One table has, for each law, size and kind of
// factorisation, the times of a step and of the factorisation of its matrix. For comparison the table has the
// times of a step of RK4 and of one evaluation of the accelerations. The other table has processor time
// against error for stiff solids that swing on a joint, by RK4 with 0.9 of its largest stable step, and by
// the implicit method with 1 to 1000 times this largest step. Writes CSV to standard output.
//
//   implicit_bench [FOLDER]     writes implicit_cost.csv and implicit_work_error.csv to FOLDER as well
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/part/local/local_laws.h>
#include <pliant/pliant.h>
#include <pliant/solve/cholmod_factor.h>
#include <pliant/solve/suitesparse.h>

#include "table_file.h"
#include "timing.h"

using namespace pliant;

namespace {

using Clock = bench::ProcessorClock;
double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// The cost of the factorisation of a sparse matrix A = L L^T.
struct Measured {
  Eigen::Index unknowns = 0, entries = 0;  // rows of the matrix; nonzeros of its factor L
  double analysis = 0, factorisation = 0;  // times of the last calls, s
};

/// A sparse factor that measures its own cost.
class MeasuredFactor final : public SparseFactor {
 public:
  MeasuredFactor(std::unique_ptr<SparseFactor> factor, Measured& measured)
      : factor_(std::move(factor)), measured_(measured) {}
  Eigen::Index nonzeros() const override { return factor_->nonzeros(); }

 private:
  void do_analyse(const SparseMatrix& A) override {
    const auto start = Clock::now();
    factor_->analyse(A);
    measured_.analysis = seconds_since(start);
    measured_.unknowns = A.rows();
  }
  bool do_factor(const SparseMatrix& A) override {
    const auto start = Clock::now();
    if (!factor_->factor(A)) return false;
    measured_.factorisation = seconds_since(start);
    measured_.entries = factor_->nonzeros();
    for (Eigen::Index i = 0; i < A.rows(); ++i)
      if (!accept_pivot(i, factor_->pivots()[static_cast<std::size_t>(i)])) return false;
    return true;
  }
  void do_solve(Eigen::Ref<Eigen::MatrixXd> x) override { factor_->solve(x); }

  std::unique_ptr<SparseFactor> factor_;
  Measured& measured_;
};

std::unique_ptr<SparseFactor> make_factor(const std::string& kind) {
  if (kind == "eigen") return make_eigen_factor();
  CholmodOptions options;
  if (kind == "simplicial") options.supernodal_from = std::numeric_limits<Eigen::Index>::max();
  return make_cholmod_factor(options);
}

/// Adds a solid that hangs from a joint at its top, with a sideways initial velocity.
void add_pendulum(MultiBody& body, const std::string& law, int resolution, double E) {
  auto& part = body.add<Primitive<Ellipsoid>>("solid", 1000.0);
  part.rest({{"a1", 0.15}, {"a2", 0.1}, {"a3", 0.4}}).place({0, 0, -0.4}).velocity({0.4, 0, 0}, {0, -1, 0});
  LocalSettings settings;
  settings.resolution = resolution;
  settings.alpha = 5;
  settings.energies = {local_law(law, {E, 0.3})};
  part.deform_locally(settings);
  body.ball("top", world(0, 0, 0), point(part, kPi / 2, 0));
}

/// Returns the processor time of a step at half the explicit limit, s. factor: kind of the factorisation.
/// measured: receives its cost.
double step_time(const std::string& law, int resolution, const std::string& method, const std::string& factor,
                 Measured& measured) {
  MultiBody body;
  body.joint_solver.make_factor = [&] {
    return std::make_unique<MeasuredFactor>(make_factor(factor), measured);
  };
  add_pendulum(body, law, resolution, 1e6);
  Simulation simulation(body, method);
  const double h = 0.5 * largest_stable_step(Simulation(body, "rk4"));
  simulation.step(h);
  return bench::seconds_per_call<Clock>([&] { simulation.step(h); }, 0.005, 20);
}

double evaluation_time(const std::string& law, int resolution) {
  MultiBody body;
  add_pendulum(body, law, resolution, 1e6);
  const Simulation simulation(body, "rk4");
  Workspace<double> work;
  const State& state = simulation.state();
  return bench::seconds_per_call<Clock>(
      [&] { simulation.dynamics().accelerations(0, state.q, state.v, state, work); }, 0.005, 20);
}

const char* const kCostHead =
    "law,resolution,unknowns,factor,entries_of_L,analysis_ms,factorisation_ms,evaluation_ms,rk4_step_ms,"
    "implicit_step_ms,implicit_per_rk4\n";

void measure_cost(const std::string& folder) {
  std::fputs(kCostHead, stdout);
  bench::TableFile file(folder.empty() ? "" : folder + "/implicit_cost.csv", kCostHead);
  for (const auto& [law, finest] : {std::pair<std::string, int>{"elastic", 8}, {"neo_hookean", 4}})
    for (const int resolution : {2, 3, 4, 6, 8}) {
      if (resolution > finest) break;
      Measured unused;
      const double evaluation = evaluation_time(law, resolution),
                   rk4 = step_time(law, resolution, "rk4", "eigen", unused);
      for (const std::string factor : {"eigen", "simplicial", "cholmod"}) {
        if (factor != "cholmod" && resolution > 6) continue;  // these factorisations would take minutes
        Measured measured;
        const double implicit = step_time(law, resolution, "linearly_implicit", factor, measured);
        char line[256];
        std::snprintf(line, sizeof line, "%s,%d,%ld,%s,%ld,%.3g,%.4g,%.4g,%.4g,%.4g,%.3g\n", law.c_str(),
                      resolution, static_cast<long>(measured.unknowns), factor.c_str(),
                      static_cast<long>(measured.entries), 1e3 * measured.analysis,
                      1e3 * measured.factorisation, 1e3 * evaluation, 1e3 * rk4, 1e3 * implicit,
                      implicit / rk4);
        std::fputs(line, stdout);
        std::fflush(stdout);
        file.row("%s", line);
      }
    }
}

const char* const kErrorHead = "law,E_Pa,method,step_per_explicit_limit,step_s,steps,seconds,error_m\n";

void measure_error(const std::string& folder) {
  std::fputs(kErrorHead, stdout);
  bench::TableFile file(folder.empty() ? "" : folder + "/implicit_work_error.csv", kErrorHead);
  const double end = 0.5;
  for (const auto& [law, E] :
       {std::pair<std::string, double>{"elastic", 1e7}, {"elastic", 1e8}, {"neo_hookean", 1e7}}) {
    struct Outcome {
      Vec3<double> c;
      double seconds;
      long steps;
    };
    auto run = [&, law = law, E = E](const std::string& method, double h) -> Outcome {
      MultiBody body;
      use_suitesparse(body.joint_solver);
      add_pendulum(body, law, 3, E);
      Simulation simulation(body, method);
      const long steps = std::max(1L, static_cast<long>(std::ceil(end / h)));
      const auto start = Clock::now();
      for (long i = 0; i < steps; ++i) simulation.step(end / static_cast<double>(steps));
      return {simulation.model().position(simulation.state(), 0), seconds_since(start), steps};
    };
    MultiBody body;
    add_pendulum(body, law, 3, E);
    const double limit = largest_stable_step(Simulation(body, "rk4"));
    // The reference: RK4 with half of the step that is measured below.
    const Outcome exact = run("rk4", 0.45 * limit);
    auto measure = [&, law = law, E = E](const char* method, double times) {
      const Outcome outcome = run(method, times * limit);
      char line[256];
      std::snprintf(line, sizeof line, "%s,%.0e,%s,%g,%.3g,%ld,%.4g,%.3g\n", law.c_str(), E, method, times,
                    end / static_cast<double>(outcome.steps), outcome.steps, outcome.seconds,
                    (outcome.c - exact.c).norm());
      std::fputs(line, stdout);
      std::fflush(stdout);
      file.row("%s", line);
    };
    measure("rk4", 0.9);
    for (const double times : {1., 3., 10., 30., 100., 300., 1000.}) measure("linearly_implicit", times);
  }
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string folder = argc > 1 ? argv[1] : "";
    measure_error(folder);
    measure_cost(folder);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "implicit_bench: %s\n", e.what());
    return 1;
  }
}
