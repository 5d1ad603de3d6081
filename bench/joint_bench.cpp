// Run time per link of an evaluation of the accelerations, of a stage of RK4 and of a step, for chains,
// trees, nets, rings and stars of growing size. The program also measures the exponents with which the time
// grows with the number of links, and the time of each stage of an evaluation.
//
//   joint_bench [FOLDER]     writes joint_bench.csv and joint_exponents.csv to FOLDER, a table to standard
//   output
//
// An evaluation of the accelerations has these stages: parts (timed with the same parts without joints),
// rows (C_q and bias), factor (M^-1 C_q^T, W_c = C_q M^-1 C_q^T and its factor), solve (lambda and
// accelerations), and a remainder with the name "rest" (points of joints, powers of forces). A stage of RK4
// needs Dynamics::rates() only, which is faster for rigid islands (rigid parts that ball joints connect). An
// evaluation is also timed with each joint solver: the blocks of W_c, and the augmented matrix of Eq. (14).
// The column auto has the solver that the default choice of JointSolver selects. The time of projection is
// the time of a step minus four stages (RK4) or one evaluation (Euler). The stages are timed one by one in
// separate loops, so their data are in the processor caches. Every time is the minimum over rounds, and each
// round measures all sizes. A longer load by other programs then does not slow one size only, which would
// change the exponents.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include <pliant/math/flush_subnormals.h>
#include <pliant/pliant.h>

#include "exponent.h"
#include "linkage.h"
#include "table_file.h"
#include "timing.h"

using namespace pliant;
using bench::Linkage;

namespace {

struct System {
  const char* name;
  bool soft;  ///< whether the semi-axes of the links are dynamic
  std::function<void(Linkage&, int)> build;
  std::vector<int> sizes;  ///< arguments of build
};

/// Times in microseconds per link.
struct Cost {
  std::string system;
  int links, joints;
  double evaluation, stage, rk4_step, euler_step;
  double parts, rows, factor, solve;
  double blocks, augmented;  ///< times of an evaluation with each solver
  bool auto_is_augmented;    ///< whether the default choice selects the augmented matrix

  void minimise_with(const Cost& other) {
    for (double Cost::*time :
         {&Cost::evaluation, &Cost::stage, &Cost::rk4_step, &Cost::euler_step, &Cost::parts, &Cost::rows,
          &Cost::factor, &Cost::solve, &Cost::blocks, &Cost::augmented})
      this->*time = std::min(this->*time, other.*time);
  }
  double rest() const { return evaluation - parts - rows - factor - solve; }
  double rk4_projection() const { return rk4_step - 4 * stage; }
  double euler_projection() const { return euler_step - evaluation; }
};

constexpr double kStep = 1e-3;
constexpr int kRounds = 3, kRepeats = 30;

template <class F>
double seconds(F&& f) {
  return bench::seconds_per_call(f, 0.002, kRepeats);
}

double step_seconds(Simulation& simulation, const State& start) {
  return bench::seconds_per_call(
      [&] {
        simulation.set_state(start);
        simulation.step(kStep);
      },
      0.02, 3);
}

/// Returns the time of an evaluation of the accelerations at a state with the given solver, s.
double evaluation_seconds(JointSolver::Choice choice, const System& system, int size, const State& state) {
  MultiBody body;
  body.joint_solver.choice = choice;
  Linkage linkage(body, system.soft);
  system.build(linkage, size);
  const Simulation simulation(body, "rk4");
  Workspace<double> work;
  return seconds([&] { simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work); });
}

Cost measure(const System& system, int size) {
  MultiBody body, loose_body;
  Linkage linkage(body, system.soft), loose_linkage(loose_body, system.soft, false);
  system.build(linkage, size);
  system.build(loose_linkage, size);
  Simulation rk4(body, "rk4"), euler(body, "semi_implicit_euler"), loose(loose_body, "rk4");
  for (int i = 0; i < 10; ++i) rk4.step(kStep);
  const State start = rk4.state();
  const Model& model = rk4.model();
  const double t = start.time(), links = static_cast<double>(body.parts().size());

  Cost cost{};
  cost.system = system.name;
  cost.links = static_cast<int>(body.parts().size());
  cost.joints = static_cast<int>(body.joints().size());
  auto per_link = [&](auto&& stage) { return seconds(stage) * 1e6 / links; };
  Workspace<double> work, loose_work;
  cost.evaluation = per_link([&] { rk4.dynamics().accelerations(t, start.q, start.v, start, work); });
  cost.stage = per_link([&] { rk4.dynamics().rates(t, start.q, start.v, start, work); });
  rk4.dynamics().accelerations(t, start.q, start.v, start, work);
  cost.parts =
      per_link([&] { loose.dynamics().accelerations(t, start.q, start.v, loose.state(), loose_work); });
  auto each_island = [&](auto&& act) {
    return [&model, act] {
      for (const Island& island : model.islands()) act(island);
    };
  };
  cost.rows = per_link(each_island(
      [&](const Island& island) { evaluate_joints<double>(model, island, t, work.parts, work.joints); }));
  cost.factor = per_link(each_island(
      [&](const Island& island) { factor_joints<double>(model, island, work.parts, work.joints); }));
  cost.solve = per_link(each_island([&](const Island& island) { solve_joints(model, island, {}, work); }));
  cost.blocks = evaluation_seconds(JointSolver::Choice::blocks, system, size, start) * 1e6 / links;
  cost.augmented = evaluation_seconds(JointSolver::Choice::augmented, system, size, start) * 1e6 / links;
  cost.auto_is_augmented = model.islands().front().augmented;
  cost.rk4_step = step_seconds(rk4, start) * 1e6 / links;
  cost.euler_step = step_seconds(euler, start) * 1e6 / links;
  return cost;
}

}  // namespace

int main(int argc, char** argv) try {
  const FlushSubnormals flushed;  // as in a step
  const std::string folder = argc > 1 ? std::string(argv[1]) + "/" : "";
  auto in_folder = [&](const char* name) { return folder.empty() ? std::string() : folder + name; };
  const double peak = bench::multiply_add_peak(), triad = bench::triad_bandwidth();
  char calibration[128];
  std::snprintf(calibration, sizeof calibration, "# multiply-adds per second %.3g, triad %.3g bytes/s\n",
                peak, triad);
  std::printf("%s", calibration);
  bench::TableFile costs_file(
      in_folder("joint_bench.csv"),
      std::string(calibration) +
          "system,links,joints,evaluation_us_per_link,stage_us_per_link,rk4_step_us_per_link,euler_step_us_"
          "per_link,"
          "parts_us,rows_us,factor_us,solve_us,rest_us,rk4_projection_us,euler_projection_us,"
          "evaluation_multiply_adds_per_link,by_blocks_us,by_augmented_us,auto\n");
  bench::TableFile exponents_file(in_folder("joint_exponents.csv"),
                                  std::string(calibration) + "system,evaluation,stage,rk4_step,euler_step\n");

  const std::vector<int> chains{8, 32, 128, 512, 1000, 2000, 5000, 10000};
  const std::vector<System> systems{
      {"chain", false, [](Linkage& linkage, int n) { bench::chain(linkage, n); }, chains},
      {"hanging chain", false, [](Linkage& linkage, int n) { bench::chain(linkage, n, true); }, chains},
      {"chain, 3 parameters", true, [](Linkage& linkage, int n) { bench::chain(linkage, n); }, chains},
      {"binary tree", false, bench::tree, {15, 127, 1023, 8191}},
      {"ring", false, bench::ring, {8, 32, 128, 512, 2000}},
      {"net", false, bench::net, {4, 8, 16, 32}},
      {"star", false, bench::star, {8, 32, 128, 256}},
  };
  std::printf(
      "microseconds per link\n%-20s %6s %6s | %8s %8s %8s %8s | %7s %7s %7s %7s %7s | %7s %7s | %8s %9s\n",
      "system", "links", "joints", "evaluate", "stage", "rk4", "euler", "parts", "rows", "factor", "solve",
      "rest", "pr.rk4", "pr.eul", "blocks", "augmented");
  for (const System& system : systems) {
    std::vector<Cost> costs;
    for (const int size : system.sizes) costs.push_back(measure(system, size));
    for (int round = 1; round < kRounds; ++round)
      for (std::size_t i = 0; i < costs.size(); ++i) costs[i].minimise_with(measure(system, system.sizes[i]));
    for (const Cost& c : costs) {
      std::printf(
          "%-20s %6d %6d | %8.3f %8.3f %8.3f %8.3f | %7.3f %7.3f %7.3f %7.3f %7.3f | %7.3f %7.3f | %8.3f "
          "%9.3f, auto: %s\n",
          c.system.c_str(), c.links, c.joints, c.evaluation, c.stage, c.rk4_step, c.euler_step, c.parts,
          c.rows, c.factor, c.solve, c.rest(), c.rk4_projection(), c.euler_projection(), c.blocks,
          c.augmented, c.auto_is_augmented ? "augmented" : "blocks");
      std::fflush(stdout);
      costs_file.row(
          "\"%s\",%d,%d,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.4f,%.0f,%.4f,%.4f,%s\n",
          c.system.c_str(), c.links, c.joints, c.evaluation, c.stage, c.rk4_step, c.euler_step, c.parts,
          c.rows, c.factor, c.solve, c.rest(), c.rk4_projection(), c.euler_projection(),
          c.evaluation * 1e-6 * peak, c.blocks, c.augmented, c.auto_is_augmented ? "augmented" : "blocks");
    }
    const double evaluation = bench::exponent(costs, &Cost::links, &Cost::evaluation),
                 stage = bench::exponent(costs, &Cost::links, &Cost::stage),
                 rk4 = bench::exponent(costs, &Cost::links, &Cost::rk4_step),
                 euler = bench::exponent(costs, &Cost::links, &Cost::euler_step);
    std::printf(
        "%-20s total time grows as the number of links to the power %.3f (evaluation), %.3f (stage), %.3f "
        "(rk4), %.3f (euler)\n",
        system.name, evaluation, stage, rk4, euler);
    exponents_file.row("\"%s\",%.4f,%.4f,%.4f,%.4f\n", system.name, evaluation, stage, rk4, euler);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
