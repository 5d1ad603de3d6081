// Run time against error for systems of joints, integrators side by side: problems on which other engines
// were measured too. All parts are rigid solids of 1000 kg/m^3, gravity 9.81 m/s^2 along -z.
//
//   joint_work_error [--all] [--only NAME] [FOLDER]
//
// writes joint_work_error.csv (bench/plot.py draws it), joint_cost.csv and joint_reference.csv to FOLDER,
// tables to standard output. --all: the long ones too.
//
//   A        free ellipsoid, semi-axes 0.3, 0.2, 0.1 m, about its unstable axis
//   B        that ellipsoid hung at the tip of its long axis and pushed sideways: spherical compound pendulum
//   C8 ...   chain of n of them tip to tip along x, released at rest, link i rolled by 0.7 i rad
//   D4 ...   net of n x n touching spheres of radius 0.1 m on a wavy surface, pinned at two corners
//
// Error: the worst distance of a body's centre from the reference at the end, in lengths of a body; of A the
// angle of rotation between them. Time: CPU time of the stepping loop, one thread. Reference: extrapolation.h
// with steps halved until two runs agree; what is left between the last two is its difference, and only
// errors above 100 times that are taken.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <pliant/pliant.h>

#include "extrapolation.h"
#include "linkage.h"
#include "table_file.h"

using namespace pliant;
using bench::Linkage;

namespace {

struct Problem {
  std::string name;
  double end;     ///< s
  double length;  ///< of a body, m
  bool long_running;
  std::function<void(MultiBody&)> build;
};

void free_ellipsoid(MultiBody& body) {
  body.gravity.setZero();
  Linkage linkage(body);
  linkage.link({-0.3, 0, 0}, Eigen::Quaterniond::Identity()).move({0, 0, 0}, {0.01, 5, 0.01});
}
void pendulum(MultiBody& body) {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(kPi / 6, Vec3<double>::UnitY()));
  const Vec3<double> omega(0, 0, 3);
  Linkage linkage(body);
  Part& part = linkage.link({0, 0, 0}, R);
  part.move(omega.cross(part.c0()), R.conjugate() * omega);
  linkage.tie(world(0, 0, 0), Linkage::near_tip(part));
}
Problem chain(int n, bool long_running = false) {
  return {"C" + std::to_string(n), 2, bench::kLinkLength, long_running, [n](MultiBody& body) {
            Linkage linkage(body);
            bench::chain(linkage, n);
          }};
}
/// Nets are chaotic: the larger, the shorter.
Problem net(int n, double end, bool long_running = false) {
  return {"D" + std::to_string(n), end, 2 * bench::kNetRadius, long_running, [n](MultiBody& body) {
            Linkage linkage(body);
            bench::net(linkage, n);
          }};
}

double error(const Model& model, double length, const VecX<double>& q, const VecX<double>& exact) {
  if (!q.allFinite() || !exact.allFinite()) return std::numeric_limits<double>::infinity();
  double worst = 0;
  for (const PartModel& part : model.parts()) {
    if (model.joints().empty()) {
      const Eigen::Quaterniond a(q[part.q0 + 3], q[part.q0 + 4], q[part.q0 + 5], q[part.q0 + 6]);
      const Eigen::Quaterniond b(exact[part.q0 + 3], exact[part.q0 + 4], exact[part.q0 + 5],
                                 exact[part.q0 + 6]);
      const Eigen::Quaterniond turn = a.conjugate() * b;
      worst = std::max(worst, 2 * std::atan2(turn.vec().norm(), std::abs(turn.w())));
    } else {
      worst = std::max(worst, (q.segment<3>(part.q0) - exact.segment<3>(part.q0)).norm() / length);
    }
  }
  return worst;
}
double worst_gap(const Model& model, const State& state) {
  double worst = 0;
  for (std::size_t j = 0; j < model.joints().size(); ++j)
    worst = std::max(worst, model.gap(state, static_cast<int>(j)));
  return worst;
}

struct Reference {
  State state;
  double step, difference;
  double gap;
};

/// The run that agrees best with that of twice its step; further ones only round.
Reference reference(const Problem& problem) {
  constexpr double kAgree = 1e-12, kFirstStep = 0.0125;
  constexpr int kMostHalvings = 6;
  MultiBody body;
  problem.build(body);
  const Simulation simulation(body, "rk4");
  Reference best{simulation.state(), 0, std::numeric_limits<double>::infinity(), 0};
  VecX<double> before;
  for (int halving = 0; halving <= kMostHalvings && best.difference > kAgree; ++halving) {
    const long steps = std::lround(problem.end / kFirstStep) << halving;
    const double h = problem.end / static_cast<double>(steps);
    bench::Extrapolation method(simulation.dynamics(), simulation.state());
    for (long i = 0; i < steps; ++i) method.step(static_cast<double>(i) * h, h);
    State state = simulation.state();
    state.q = method.q();
    const double difference =
        halving == 0 ? best.difference : error(simulation.model(), problem.length, before, state.q);
    before = state.q;
    if (difference < best.difference) best = {state, h, difference, worst_gap(simulation.model(), state)};
  }
  return best;
}

struct Run {
  double step;
  long evaluations;
  double cpu_ms, error;
  double balance, kinetic;  ///< worst and largest on the way, J
  double gap;               ///< worst on the way, m
};

/// Throws StepFailure.
Run run(const Problem& problem, const std::string& method, long steps, const Reference& exact) {
  constexpr double kEnough = 0.2;  // s
  constexpr int kSamples = 20, kMostRepeats = 50;
  MultiBody body;
  problem.build(body);
  Simulation simulation(body, method);
  const State start = simulation.state();
  const double h = problem.end / static_cast<double>(steps);
  Run result{};
  double spent = 0, least = std::numeric_limits<double>::infinity();
  for (int repeat = 0; repeat < kMostRepeats && spent < kEnough; ++repeat) {
    simulation.set_state(start);
    double seconds = 0;
    long done = 0;
    for (int sample = 1; sample <= kSamples; ++sample) {
      const long until = steps * sample / kSamples;
      const std::clock_t begin = std::clock();
      for (; done < until; ++done) simulation.step(h);
      seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
      if (repeat > 0) continue;
      const Ledger ledger = simulation.ledger();
      result.balance = std::max(result.balance, std::abs(ledger.balance));
      result.kinetic = std::max(result.kinetic, ledger.kinetic);
      result.gap = std::max(result.gap, worst_gap(simulation.model(), simulation.state()));
    }
    if (repeat == 0) result.evaluations = simulation.step_counters().evaluations;
    least = std::min(least, seconds);
    spent += seconds;
  }
  result.step = h;
  result.cpu_ms = least * 1e3;
  result.error = error(simulation.model(), problem.length, simulation.state().q, exact.state.q);
  return result;
}

/// Median of what each halving of the step makes of the error, where that is below a twentieth; NaN below two
/// halvings.
double observed_order(const std::vector<Run>& runs) {
  std::vector<double> orders;
  for (std::size_t i = 1; i < runs.size(); ++i)
    if (runs[i - 1].error < 0.05) orders.push_back(std::log2(runs[i - 1].error / runs[i].error));
  if (orders.size() < 2) return std::numeric_limits<double>::quiet_NaN();
  std::sort(orders.begin(), orders.end());
  return (orders[(orders.size() - 1) / 2] + orders[orders.size() / 2]) / 2;
}

/// CPU time at an error, log-log between the runs on either side, from where all finer ones are below it; NaN
/// when none is.
double cost_at(const std::vector<Run>& runs, double level) {
  for (std::size_t i = runs.size(); i-- > 0;) {
    if (runs[i].error <= level) continue;
    if (i + 1 == runs.size()) return std::numeric_limits<double>::quiet_NaN();
    const Run &above = runs[i], &below = runs[i + 1];
    const double part = std::log(above.error / level) / std::log(above.error / below.error);
    return above.cpu_ms * std::pow(below.cpu_ms / above.cpu_ms, part);
  }
  return runs.empty() ? std::numeric_limits<double>::quiet_NaN() : runs.front().cpu_ms;
}
/// CPU time of the cheapest run with at most this error that neither of the next two finer ones is three
/// times worse than; NaN when there is none.
double cost_of_run(const std::vector<Run>& runs, double level) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    bool counts = runs[i].error <= level;
    for (std::size_t k = i + 1; k < std::min(i + 3, runs.size()); ++k)
      counts = counts && runs[k].error <= 3 * runs[i].error;
    if (counts) least = std::min(least, runs[i].cpu_ms);
  }
  return std::isfinite(least) ? least : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

int main(int argc, char** argv) try {
  bool all = false;
  std::string folder, only;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--all") == 0)
      all = true;
    else if (std::strcmp(argv[i], "--only") == 0 && i + 1 < argc)
      only = argv[++i];
    else
      folder = std::string(argv[i]) + "/";
  }
  auto in_folder = [&](const char* name) { return folder.empty() ? std::string() : folder + name; };
  bench::TableFile runs_file(
      in_folder("joint_work_error.csv"),
      "problem,method,step_s,evaluations,cpu_ms,cpu_ms_per_s,error,balance_J,kinetic_J,"
      "gap_m,reference_step_s,reference_difference\n");
  bench::TableFile cost_file(
      in_folder("joint_cost.csv"),
      "problem,method,error,cpu_ms_per_s_interpolated,cpu_ms_per_s_of_run,observed_order\n");
  bench::TableFile reference_file(in_folder("joint_reference.csv"),
                                  "problem,part,t_s,x,y,z,qw,qx,qy,qz,step_s,difference,gap_m\n");

  const std::vector<Problem> problems{{"A", 10, 1, false, free_ellipsoid},
                                      {"B", 10, bench::kLinkLength, false, pendulum},
                                      chain(2),
                                      chain(8),
                                      chain(32),
                                      chain(128),
                                      net(4, 1),
                                      net(8, 0.5),
                                      chain(512, true),
                                      net(16, 0.25, true)};
  constexpr double kLevels[] = {1e-2, 1e-3, 1e-4, 1e-6, 1e-8};
  // Steps from 0.05 s on are halved until the error is this small or the run this long.
  constexpr double kFirstStep = 0.05, kSmallest = 1e-9;
  constexpr int kLeastRuns = 6, kMostHalvings = 24;
  // Evaluations times joints.
  auto most_work = [&](int order) { return (order == 1 ? 2e6 : 2e7) * (all ? 4 : 1); };

  for (const Problem& problem : problems) {
    if (only.empty() ? problem.long_running && !all : only != problem.name) continue;
    const Reference exact = reference(problem);
    MultiBody body;
    problem.build(body);
    const double weight = static_cast<double>(std::max<std::size_t>(1, body.joints().size()));
    const auto parts = body.parts().size();
    std::printf("%s: reference by steps of %g s, which differ by %.1e from those twice as long; gap %.1e m\n",
                problem.name.c_str(), exact.step, exact.difference, exact.gap);
    for (std::size_t i = 0; i < parts; ++i) {
      const auto at = static_cast<Eigen::Index>(7 * i);
      const VecX<double>& q = exact.state.q;
      reference_file.row("%s,%zu,%g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%g,%.3e,%.3e\n",
                         problem.name.c_str(), i, problem.end, q[at], q[at + 1], q[at + 2], q[at + 3],
                         q[at + 4], q[at + 5], q[at + 6], exact.step, exact.difference, exact.gap);
    }
    const double floor = std::max(kSmallest, 100 * exact.difference);
    for (const IntegratorInfo& method : all_integrators()) {
      std::vector<Run> runs;
      for (int halving = 0; halving < kMostHalvings; ++halving) {
        const long steps = std::lround(problem.end / kFirstStep) << halving;
        Run r;
        try {
          r = run(problem, method.name, steps, exact);
        } catch (const StepFailure&) {
          continue;  // too long a step
        }
        if (!(r.error >= 100 * exact.difference)) break;
        runs.push_back(r);
        runs_file.row("%s,%s,%g,%ld,%.4f,%.4f,%.3e,%.3e,%.3e,%.3e,%g,%.3e\n", problem.name.c_str(),
                      method.name, r.step, r.evaluations, r.cpu_ms, r.cpu_ms / problem.end, r.error,
                      r.balance, r.kinetic, r.gap, exact.step, exact.difference);
        std::printf("  %-20s h %9.3g s  %9.2f ms  error %.2e  balance %.1e of %.1e J  gap %.1e m\n",
                    method.name, r.step, r.cpu_ms, r.error, r.balance, r.kinetic, r.gap);
        std::fflush(stdout);
        const bool enough = static_cast<int>(runs.size()) >= kLeastRuns;
        if (enough &&
            (r.error <= floor || 2 * weight * static_cast<double>(r.evaluations) > most_work(method.order)))
          break;
      }
      const double order = observed_order(runs);
      std::printf("  %-20s observed order %.2f; CPU ms per simulated s (of one run) at error", method.name,
                  order);
      for (const double level : kLevels) {
        const double between = cost_at(runs, level) / problem.end,
                     of = cost_of_run(runs, level) / problem.end;
        std::printf("  %g: %.3g (%.3g)", level, between, of);
        cost_file.row("%s,%s,%g,%.4g,%.4g,%.3f\n", problem.name.c_str(), method.name, level, between, of,
                      order);
      }
      std::printf("\n");
    }
  }
  return 0;
} catch (const std::exception& fault) {
  std::fprintf(stderr, "%s\n", fault.what());
  return 1;
}
