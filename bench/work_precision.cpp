// Run time against error of every method of integration, on the problems of problems.h.
//
//   work_precision [--all] [--only PROBLEM] [--again] [FOLDER]
//
// writes to FOLDER work_precision.csv (one row for each run; bench/plot.py draws it), precision_cost.csv
// (time at a given error), precision_auto.csv (time of auto over the time of the best method) and
// precision_reference.csv (final positions), and tables to standard output. --all: the long problems too, and
// four times as long runs. --again: rows of FOLDER for problems that are not measured stay. Of two runs with
// as many steps and evaluations the smaller time counts: on a shared machine some rounds of the same code
// give the true cost.
//
// Methods without error control take steps of 0.05 s, or eight a run, then each half as long; the others
// tolerances from 0.1 on, each a tenth of the last. linearly_implicit is measured in both ways, with a
// tolerance as linearly_implicit_controlled. Each method has at least six settings that succeed; the sweep
// ends when a run takes 4 s, or when errors are below those of the reference.
//
// error: of positions at the end over the length of their bodies, or of all coordinates (error_scale.h);
// error_along: the worst at eight moments of a run that stops at each, as for gaps and energies; error_v: of
// velocities at the end, over the fastest; error_lambda: of the forces of joints at the end, over the
// largest.
//
// Time: CPU time of the stepping loop, one thread, the minimum of several runs without stops, without the
// trial of auto.
//
// Reference: collocation, with its difference from extrapolation (reference_methods.h). For nodes and closing
// joints: dop853 to 1e-12 and dormand_prince to 1e-11, or the smallest tolerance that rounding allows; both
// use the projection of the engine and its search for the time of closing. For contact: dop853 to 1e-10 and
// rk4, each in short steps and in half as long ones, extrapolated, because the error of lasting contact is of
// first order. Errors below 100 times the difference of the references are replaced by that bound; velocities
// and forces have differences of their own.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <exception>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/advance.h>
#include <pliant/pliant.h>

#include "problems.h"
#include "reference_methods.h"
#include "table_file.h"

using namespace pliant;
using bench::Problem;

namespace {

constexpr int kSamples = 8;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// Names of the rows with steps of one length, and with a tolerance.
const std::string kFixed = "linearly_implicit", kControlled = kFixed + "_controlled";

/// A setting of a method: a tolerance, or a number of steps.
struct Setting {
  std::string method;
  double tolerance;
  long steps;
};

/// A run: its states at the samples and at the end, the forces of joints at the end, and its cost.
struct Outcome {
  std::vector<State> states;
  State end;  // of a reference: the last of them
  VecX<double> lambda;
  double cpu_ms = 0, balance = 0, kinetic = 0, gap = 0;
  long evaluations = 0, steps = 0;
};

double worst_gap(const Model& model, const State& state) {
  double worst = 0;
  for (std::size_t j = 0; j < model.joints().size(); ++j)
    if (state.joints[j] == JointMode::closed) worst = std::max(worst, model.gap(state, static_cast<int>(j)));
  return worst;
}

/// Advances from the start to the end in parts of equal length, with a call after each, whose processor time
/// is not counted. Returns the time of the parts, s. Throws StepFailure.
template <class F>
double go(const Problem& problem, const Setting& setting, int parts, F&& after_part) {
  MultiBody body;
  problem.build(body);
  Simulation simulation(body, setting.method, 1, setting.tolerance);
  double seconds = 0;
  for (int part = 1; part <= parts; ++part) {
    const double until = problem.end * part / parts;
    const std::clock_t begin = std::clock();
    if (setting.tolerance > 0) {
      while (simulation.time() < until) simulation.step_up_to(until);
    } else {
      for (long i = 0; i < setting.steps / parts; ++i)
        simulation.step(problem.end / static_cast<double>(setting.steps));
    }
    seconds += static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC;
    after_part(simulation);
  }
  return seconds;
}

/// Runs once with samples, then repeats for the timing until `repeats` seconds are spent. Samples would cut
/// steps to a tolerance, so that timed runs go to the end at once; results at the end are of the timed runs.
/// Throws StepFailure.
Outcome run(const Problem& problem, const Setting& setting, double repeats = 0) {
  Outcome result;
  auto at_end = [&](const Simulation& simulation) {
    result.end = simulation.state();
    result.evaluations = simulation.step_counters().evaluations;
    result.steps = simulation.step_counters().steps;
    Workspace<double> work;
    simulation.dynamics().accelerations(result.end.time(), result.end.q, result.end.v, result.end, work);
    result.lambda = work.joints.lambda;
  };
  double least = go(problem, setting, kSamples, [&](Simulation& simulation) {
    const Ledger ledger = simulation.ledger();
    result.balance = std::max(result.balance, std::abs(ledger.balance));
    result.kinetic = std::max(result.kinetic, ledger.kinetic);
    result.gap = std::max(result.gap, worst_gap(simulation.model(), simulation.state()));
    result.states.push_back(simulation.state());
    at_end(simulation);
  });
  double spent = least;
  if (setting.tolerance > 0 && repeats > 0) {
    least = std::numeric_limits<double>::infinity();
    spent = 0;
  }
  while (spent < repeats) {
    const double seconds = go(problem, setting, 1, at_end);
    least = std::min(least, seconds);
    spent += seconds;
  }
  result.cpu_ms = least * 1e3;
  return result;
}

/// Measures errors by a model of the problem.
class Meter {
 public:
  explicit Meter(const Problem& problem) : length_(problem.length) {
    problem.build(body_);
    simulation_ = std::make_unique<Simulation>(body_);
    scale_ = std::make_unique<ErrorScale>(simulation_->model(), 1);
  }
  const Model& model() const { return simulation_->model(); }

  double of_places(const State& a, const State& b) const {
    if (!a.q.allFinite() || !b.q.allFinite()) return std::numeric_limits<double>::infinity();
    if (length_ == 0) return scale_->norm(a.q - b.q);
    double worst = 0;
    for (const PartModel& part : model().parts())
      if (part.q0 >= 0)
        worst = std::max(worst, (a.q.segment<3>(part.q0) - b.q.segment<3>(part.q0)).norm() / length_);
    return worst;
  }
  double along(const Outcome& a, const Outcome& b) const {
    double worst = 0;
    for (std::size_t i = 0; i < a.states.size(); ++i)
      worst = std::max(worst, of_places(a.states[i], b.states[i]));
    return worst;
  }
  double of_velocities(const Outcome& a, const Outcome& b) const {
    return scale_->norm(VecX<double>::Zero(a.end.q.size()), a.end.v - b.end.v, b.end.v);
  }
  /// Returns the difference over the largest entry of b; NaN if b is empty.
  static double of_forces(const Outcome& a, const Outcome& b) {
    const double largest = b.lambda.size() > 0 ? b.lambda.cwiseAbs().maxCoeff() : 0;
    return largest > 0 ? (a.lambda - b.lambda).cwiseAbs().maxCoeff() / largest : kNone;
  }

 private:
  double length_;
  MultiBody body_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<ErrorScale> scale_;
};

/// Returns whether the motion is one smooth function of time that follows from accelerations: closed joints,
/// no nodes, whose stiffness would bound the steps.
bool is_smooth(const Problem& problem) {
  MultiBody body;
  problem.build(body);
  const Simulation simulation(body);
  const Model& model = simulation.model();
  const std::vector<JointMode>& joints = simulation.state().joints;
  return !body.contact.active && std::all_of(joints.begin(), joints.end(), [](JointMode mode) {
    return mode == JointMode::closed;
  }) && std::all_of(model.parts().begin(), model.parts().end(), [](const PartModel& part) {
    return part.local == nullptr;
  });
}

/// Runs a method to the smallest tolerance that rounding allows: from `finest` on, each ten times the last.
Outcome to_the_finest(const Problem& problem, const std::string& method, double finest) {
  constexpr double kCoarsest = 1e-9;
  for (double tolerance = finest;; tolerance *= 10) try {
      return run(problem, {method, tolerance, 0});
    } catch (const StepFailure&) {
      if (tolerance > kCoarsest) throw;
    }
}

/// Runs a method of reference_methods.h with the step that agrees best with the step of twice the length;
/// shorter steps only add rounding.
template <class Method>
Outcome smooth(const Problem& problem, const Meter& meter) {
  constexpr double kAgree = 1e-14, kFirstStep = 0.0125;
  constexpr int kMostHalvings = 6;
  MultiBody body;
  problem.build(body);
  const Simulation simulation(body, "rk4");
  Outcome best, before;
  double least = std::numeric_limits<double>::infinity();
  for (int halving = 0; halving <= kMostHalvings && least > kAgree; ++halving) {
    const long each = std::max(1L, std::lround(problem.end / kSamples / kFirstStep)) << halving;
    const double h = problem.end / kSamples / static_cast<double>(each);
    Method method(simulation.dynamics(), simulation.state());
    Outcome now;
    for (long i = 0; i < kSamples * each; ++i) {
      method.step(static_cast<double>(i) * h, h);
      if ((i + 1) % each != 0) continue;
      State& state = now.states.emplace_back(simulation.state());
      state.q = method.q();
      state.v = method.v();
      normalise_rotations(simulation.model(), state.q);
      now.gap = std::max(now.gap, worst_gap(simulation.model(), state));
    }
    const double difference = halving == 0 ? least : meter.along(now, before);
    before = now;
    if (halving > 0 && !(difference < least)) continue;
    least = difference;
    best = now;
  }
  if (best.states.empty())
    throw std::runtime_error(problem.name + ": no step is short enough for a reference");
  best.end = best.states.back();
  Workspace<double> work;
  simulation.dynamics().accelerations(problem.end, best.end.q, best.end.v, best.end, work);
  best.lambda = work.joints.lambda;
  return best;
}

/// Extrapolates two runs of first order; the second has half the step.
Outcome limit_of(const Outcome& coarse, Outcome fine, const Model& model) {
  for (std::size_t i = 0; i < fine.states.size(); ++i) {
    fine.states[i].q = (2 * fine.states[i].q - coarse.states[i].q).eval();
    fine.states[i].v = (2 * fine.states[i].v - coarse.states[i].v).eval();
    normalise_rotations(model, fine.states[i].q);
  }
  fine.end = fine.states.back();
  fine.lambda = (2 * fine.lambda - coarse.lambda).eval();
  return fine;
}

struct Cost {
  double cpu_ms, error;
};

/// Returns the CPU time at an error, by log-log interpolation between the runs on either side, from where all
/// finer runs are below it; NaN if there are none.
double cost_at(const std::vector<Cost>& runs, double level) {
  for (std::size_t i = runs.size(); i-- > 0;) {
    if (runs[i].error <= level) continue;
    if (i + 1 == runs.size()) return kNone;
    const Cost &above = runs[i], &below = runs[i + 1];
    const double part = std::log(above.error / level) / std::log(above.error / below.error);
    return above.cpu_ms * std::pow(below.cpu_ms / above.cpu_ms, part);
  }
  return runs.empty() ? kNone : runs.front().cpu_ms;
}
/// Returns the CPU time of the cheapest run with at most this error for which the next two finer runs are at
/// most three times worse; NaN if there is none.
double cost_of_run(const std::vector<Cost>& runs, double level) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    bool counts = runs[i].error <= level;
    for (std::size_t k = i + 1; k < std::min(i + 3, runs.size()); ++k)
      counts = counts && runs[k].error <= 3 * runs[i].error;
    if (counts) least = std::min(least, runs[i].cpu_ms);
  }
  return std::isfinite(least) ? least : kNone;
}

/// The rows of earlier rounds in a folder.
class Rounds {
 public:
  /// is_measured: whether a problem is measured now, by name. again: whether earlier rows count.
  Rounds(std::string folder, bool again, std::function<bool(const std::string&)> is_measured)
      : folder_(std::move(folder)), again_(again), is_measured_(std::move(is_measured)) {}

  /// Opens a file of the folder, with the rows that stay.
  std::unique_ptr<bench::TableFile> open(const char* name, const std::string& head) const {
    const std::string path = folder_.empty() ? "" : folder_ + name;
    const auto rows = again_ ? bench::read_rows(path, head) : decltype(bench::read_rows(path, head))();
    auto file = std::make_unique<bench::TableFile>(path, head);
    for (const std::vector<std::string>& row : rows)
      if (!is_measured_(row.front())) file->row(row);
    return file;
  }
  /// Runs of earlier rounds, by the first columns of their rows.
  void read_runs(const char* name, const std::string& head) {
    if (!again_) return;
    for (const std::vector<std::string>& row : bench::read_rows(folder_ + name, head))
      if (row.size() > kTime && !row[kTime].empty()) least_[key(row)] = std::stod(row[kTime]);
  }
  /// Returns the smallest time of a run, including `measured`, ms. run: the cells before the time.
  double least(const std::string& run, double cpu_ms) const {
    const auto found = least_.find(run);
    return found == least_.end() ? cpu_ms : std::min(cpu_ms, found->second);
  }

 private:
  static constexpr std::size_t kTime = 5;  // its column
  static std::string key(const std::vector<std::string>& row) {
    std::string key;
    for (std::size_t i = 0; i < kTime; ++i) key += row[i] + ",";
    return key;
  }

  std::string folder_;
  bool again_;
  std::function<bool(const std::string&)> is_measured_;
  std::map<std::string, double> least_;
};

/// The time of auto at an error against that of the best method. Levels that the same two runs reach count
/// once.
class Choices {
 public:
  explicit Choices(const Rounds& rounds)
      : file_(rounds.open("precision_auto.csv",
                          "problem,error,auto_cpu_ms_per_s,best_cpu_ms_per_s,best,auto_over_best\n")) {}
  /// NaN: the method does not reach this error.
  void add(const std::string& method, double error, double cpu_ms) {
    if (std::isnan(cpu_ms)) return;
    if (method == kAutomatic)
      automatic_[error] = cpu_ms;
    else if (best_.count(error) == 0 || cpu_ms < best_[error].cpu_ms)
      best_[error] = {method, cpu_ms};
  }
  void end_problem(const std::string& name) {
    double last = 0;
    for (const auto& [error, best] : best_) {
      const auto chosen = automatic_.find(error);
      if (chosen == automatic_.end()) {
        file_->row("%s,%g,,%.4g,%s,\n", name.c_str(), error, best.cpu_ms, best.method.c_str());
        missed_ += (missed_.empty() ? "" : ", ") + name + " at " + level_text(error);
        continue;
      }
      const double cpu_ms = chosen->second, ratio = cpu_ms / best.cpu_ms;
      if (ratio == last) continue;
      last = ratio;
      file_->row("%s,%g,%.4g,%.4g,%s,%.3f\n", name.c_str(), error, cpu_ms, best.cpu_ms, best.method.c_str(),
                 ratio);
      sum_ += std::log(ratio);
      ++count_;
      if (!(ratio <= most_)) {
        most_ = ratio;
        worst_ = name;
      }
    }
    automatic_.clear();
    best_.clear();
  }
  void tell() const {
    std::printf("auto over the best method: %.2f in the geometric mean over %d levels, %.2f at most (%s)\n",
                std::exp(sum_ / std::max(1, count_)), count_, most_, worst_.c_str());
    std::printf("not reached by auto: %s\n", missed_.empty() ? "none" : missed_.c_str());
  }

 private:
  struct Best {
    std::string method;
    double cpu_ms;
  };
  std::unique_ptr<bench::TableFile> file_;
  static std::string level_text(double level) {
    char text[16];
    std::snprintf(text, sizeof text, "%g", level);
    return text;
  }

  std::map<double, double> automatic_;  // by error
  std::map<double, Best, std::greater<>> best_;
  double sum_ = 0, most_ = 0;
  int count_ = 0;
  std::string worst_, missed_;
};

/// Returns the settings of a method, from the coarsest on.
std::vector<Setting> settings_of(const std::string& method, bool controlled, double end) {
  std::vector<Setting> all;
  if (controlled) {
    for (double tolerance = 0.1; tolerance > 5e-13; tolerance *= 0.1) all.push_back({method, tolerance, 0});
    return all;
  }
  const long first = kSamples * std::max(1L, std::lround(end / 0.05 / kSamples));
  for (int halving = 0; halving < 22; ++halving) all.push_back({method, 0, first << halving});
  return all;
}

}  // namespace

int main(int argc, char** argv) try {
  bool all = false, again = false;
  std::string folder, only;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--all") == 0)
      all = true;
    else if (std::strcmp(argv[i], "--again") == 0)
      again = true;
    else if (std::strcmp(argv[i], "--only") == 0 && i + 1 < argc)
      only = argv[++i];
    else
      folder = std::string(argv[i]) + "/";
  }
  std::vector<Problem> problems;
  for (Problem& problem : bench::problems())
    if (only.empty() ? all || !problem.long_running : only == problem.name)
      problems.push_back(std::move(problem));
  if (problems.empty()) throw std::invalid_argument("there is no problem " + only);
  Rounds rounds(folder, again, [&](const std::string& name) {
    return std::any_of(problems.begin(), problems.end(),
                       [&](const Problem& problem) { return problem.name == name; });
  });
  const char* const runs_name = "work_precision.csv";
  const std::string runs_head =
      "problem,method,step_or_tolerance,steps,evaluations,cpu_ms,cpu_ms_per_s,error,error_along,error_v,"
      "error_lambda,gap_m,balance_J,kinetic_J,failed,reference_difference,reference_difference_v,"
      "reference_difference_lambda\n";
  rounds.read_runs(runs_name, runs_head);
  const auto runs_file = rounds.open(runs_name, runs_head);
  const auto cost_file = rounds.open("precision_cost.csv",
                                     "problem,method,error,cpu_ms_per_s_interpolated,cpu_ms_per_s_of_run\n");
  const auto reference_file =
      rounds.open("precision_reference.csv", "problem,part,t_s,x,y,z,qw,qx,qy,qz,difference,gap_m\n");
  Choices choices(rounds);
  constexpr double kLevels[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}, kResolved = 100, kAgreement = 1e-6;
  constexpr std::size_t kFewest = 6;
  const double most_ms = all ? 16e3 : 4e3, enough = 0.05;
  std::vector<std::string> methods{kAutomatic};
  for (const IntegratorInfo& info : all_integrators()) methods.emplace_back(info.name);
  methods.insert(std::find(methods.begin(), methods.end(), kFixed) + 1, kControlled);

  for (const Problem& problem : problems) {
    const Meter meter(problem);
    const bool touches = meter.model().body().contact.active;
    constexpr long steps = 1L << 17;
    Outcome exact, other;
    if (is_smooth(problem)) {
      exact = smooth<bench::Collocation>(problem, meter);
      other = smooth<bench::Extrapolation>(problem, meter);
    } else if (touches) {
      exact = to_the_finest(problem, "dop853", 1e-10);
      other = limit_of(run(problem, {"rk4", 0, steps}), run(problem, {"rk4", 0, 2 * steps}), meter.model());
    } else {
      exact = to_the_finest(problem, "dop853", 1e-12);
      other = to_the_finest(problem, "dormand_prince", 1e-11);
    }
    exact.end = exact.states.back();
    other.end = other.states.back();
    const double difference = meter.along(other, exact), difference_v = meter.of_velocities(other, exact),
                 difference_lambda = Meter::of_forces(other, exact);
    for (const double most : {difference, difference_v, difference_lambda})
      if (most > kAgreement || std::isnan(difference) || std::isnan(difference_v))
        throw std::runtime_error(problem.name + ": the references differ by " + std::to_string(most));
    std::printf("%s: the two references differ by %.1e, velocities by %.1e, forces by %.1e; gap %.1e m\n",
                problem.name.c_str(), difference, difference_v, difference_lambda, exact.gap);
    for (std::size_t i = 0; i < meter.model().parts().size(); ++i) {
      const int at = meter.model().parts()[i].q0;
      if (at < 0) continue;
      const VecX<double>& q = exact.end.q;
      reference_file->row("%s,%zu,%g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.3e,%.3e\n",
                          problem.name.c_str(), i, problem.end, q[at], q[at + 1], q[at + 2], q[at + 3],
                          q[at + 4], q[at + 5], q[at + 6], difference, exact.gap);
    }
    for (const std::string& method : methods) {
      const bool controlled = method == kAutomatic || method == kControlled ||
                              (make_integrator(method)->error_order() > 0 && method != kFixed);
      std::vector<Cost> points;
      for (const Setting& setting :
           settings_of(method == kControlled ? kFixed : method, controlled, problem.end)) {
        const double asked =
            controlled ? setting.tolerance : problem.end / static_cast<double>(setting.steps);
        Outcome of;
        try {
          of = run(problem, setting, enough);
        } catch (const StepFailure&) {
          runs_file->row("%s,%s,%g,,,,,,,,,,,,1,%.3e,%.3e,%.3e\n", problem.name.c_str(), method.c_str(),
                         asked, difference, difference_v, difference_lambda);
          continue;
        }
        char key[160];
        std::snprintf(key, sizeof key, "%s,%s,%g,%ld,%ld,", problem.name.c_str(), method.c_str(), asked,
                      of.steps, of.evaluations);
        of.cpu_ms = rounds.least(key, of.cpu_ms);
        // The reference is known to the difference of its two methods only.
        auto resolved = [](double error, double between) { return std::max(error, kResolved * between); };
        const double error = resolved(meter.of_places(of.end, exact.end), difference),
                     along = resolved(meter.along(of, exact), difference);
        points.push_back({of.cpu_ms, error});
        runs_file->row("%s%.4f,%.4f,%.3e,%.3e,%.3e,%.3e,%.3e,%.3e,%.3e,0,%.3e,%.3e,%.3e\n", key, of.cpu_ms,
                       of.cpu_ms / problem.end, error, along,
                       told(meter.of_velocities(of, exact), difference_v),
                       told(Meter::of_forces(of, exact), difference_lambda), of.gap, of.balance, of.kinetic,
                       difference, difference_v, difference_lambda);
        std::printf("  %-20s %9.3g  %8ld steps  %9.2f ms  error %.2e, along %.2e\n", method.c_str(), asked,
                    of.steps, of.cpu_ms, error, along);
        std::fflush(stdout);
        const bool enough_told = error <= kResolved * difference || error < 1e-11;
        if (points.size() >= kFewest && (of.cpu_ms > most_ms || enough_told)) break;
      }
      std::printf("  %-20s CPU ms per simulated s (of one run) at error", method.c_str());
      for (const double level : kLevels) {
        const double between = cost_at(points, level) / problem.end,
                     of = cost_of_run(points, level) / problem.end;
        std::printf("  %g: %.3g (%.3g)", level, between, of);
        cost_file->row("%s,%s,%g,%.4g,%.4g\n", problem.name.c_str(), method.c_str(), level, between, of);
        choices.add(method, level, of);
      }
      std::printf("\n");
    }
    choices.end_problem(problem.name);
  }
  choices.tell();
  return 0;
} catch (const std::exception& fault) {
  std::fprintf(stderr, "%s\n", fault.what());
  return 1;
}
