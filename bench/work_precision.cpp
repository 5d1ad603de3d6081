// Run time against error of every method of integration, over the problems of problems.h.
//
//   work_precision [--all] [--only PROBLEM] [--again] [FOLDER]
//
//   FOLDER     the program writes four files to it:
//                work_precision.csv       one row per run; bench/plot.py draws it
//                precision_cost.csv       time that each method needs for given errors
//                precision_auto.csv       time of auto / time of the best single method
//                precision_reference.csv  poses of the bodies at the end
//   --all      measures the long problems too, with a time limit of 16 s per run instead of 4 s
//   --only     measures this problem only
//   --again    preserves the rows in FOLDER of problems that are not measured now. If FOLDER already contains
//              the same run, with equal numbers of steps and evaluations, the smaller time is written. Use
//              --again on a machine with other load, because the minimum over rounds is more reliable.
//
// Tables go to standard output.
//
// Methods without error control start with steps of 0.05 s, or with eight steps per run; each further setting
// halves the step. Methods with error control start with the tolerance 0.1; each further setting divides it
// by ten. linearly_implicit is measured with fixed steps, and with tolerances as
// linearly_implicit_controlled. A method is measured with at least six settings that succeed. After them, the
// measurement stops if a run exceeds the time limit, or if the error is below 1e-11 or below the resolution
// of the reference.
//
// error: error of the positions of the bodies at the end, divided by the length of a body; for problems
// without such a length, error of all coordinates at the end (error_scale.h). error_along: the maximum of
// this error at eight times, in a run that stops at each of these times. Gaps and energy errors are maxima
// over these times too. error_v: error of the velocities at the end, relative to the fastest rate of each
// part (error_scale.h). error_lambda: error of the joint forces at the end, relative to the largest joint
// force.
//
// The time is the CPU time of the stepping loop, with one thread, and the minimum of several runs without
// intermediate stops. It does not include the trial by which auto chooses its method.
//
// The reference is the result of collocation. Its accuracy is estimated by its difference from the result of
// extrapolation (reference_methods.h). For problems with nodes, or with joints that close, the two results
// are those of dop853 with a tolerance of 1e-12 and of dormand_prince with 1e-11, or with the smallest
// tolerance that rounding permits. These two methods are different, but both use the projection of pliant and
// its search for the times at which joints close. For problems with contact, the results are those of dop853
// with 1e-10, and of rk4 extrapolated from short steps and steps of half this length, because the errors of
// resting contacts may be of first order. Errors below 100 times the difference of the two results are
// written as 100 times the difference. Velocities and forces have differences of their own.
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
/// Names, in the tables, of the linearly implicit method with fixed steps and with error control.
const std::string kFixed = "linearly_implicit", kControlled = kFixed + "_controlled";

/// A method, and how its steps are chosen: by a tolerance, or, if the tolerance is 0, as equal steps.
struct Setting {
  std::string method;
  double tolerance;
  long steps;
};

/// The results of a run: the states at the kSamples times and at the end, the joint forces (N, N m) at the
/// end, and the cost. The error of the energy balance (J), the kinetic energy (J) and the gap (m) are maxima
/// over these times.
struct Outcome {
  std::vector<State> states;
  State end;  // for a reference, the last of the states
  VecX<double> lambda;
  double cpu_ms = 0, balance = 0, kinetic = 0, gap = 0;
  long evaluations = 0, steps = 0;
};

/// Returns the widest gap of the closed joints, m.
double worst_gap(const Model& model, const State& state) {
  double worst = 0;
  for (std::size_t j = 0; j < model.joints().size(); ++j)
    if (state.joints[j] == JointMode::closed) worst = std::max(worst, model.gap(state, static_cast<int>(j)));
  return worst;
}

/// Simulates from the start to the end in `intervals` intervals of equal length and calls after_interval
/// after each of them. Returns the processor time in s, without that of after_interval. Throws StepFailure.
template <class F>
double simulate(const Problem& problem, const Setting& setting, int intervals, F&& after_interval) {
  MultiBody body;
  problem.build(body);
  Simulation simulation(body, setting.method, 1, setting.tolerance);
  double seconds = 0;
  for (int interval = 1; interval <= intervals; ++interval) {
    const double until = problem.end * interval / intervals;
    const std::clock_t start = std::clock();
    if (setting.tolerance > 0) {
      while (simulation.time() < until) simulation.step_up_to(until);
    } else {
      for (long i = 0; i < setting.steps / intervals; ++i)
        simulation.step(problem.end / static_cast<double>(setting.steps));
    }
    seconds += static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    after_interval(simulation);
  }
  return seconds;
}

/// Simulates once with kSamples stops, at which it samples the state, and then repeatedly until
/// `timed_seconds` seconds are used. With a tolerance the timed runs have no samples, because samples would
/// shorten steps. In that case the values at the end are those of the timed runs. Throws StepFailure.
Outcome run(const Problem& problem, const Setting& setting, double timed_seconds = 0) {
  Outcome result;
  auto at_end = [&](const Simulation& simulation) {
    result.end = simulation.state();
    result.evaluations = simulation.step_counters().evaluations;
    result.steps = simulation.step_counters().steps;
    Workspace<double> work;
    simulation.dynamics().accelerations(result.end.time(), result.end.q, result.end.v, result.end, work);
    result.lambda = work.joints.lambda;
  };
  double min_seconds = simulate(problem, setting, kSamples, [&](Simulation& simulation) {
    const Ledger ledger = simulation.ledger();
    result.balance = std::max(result.balance, std::abs(ledger.balance));
    result.kinetic = std::max(result.kinetic, ledger.kinetic);
    result.gap = std::max(result.gap, worst_gap(simulation.model(), simulation.state()));
    result.states.push_back(simulation.state());
    at_end(simulation);
  });
  double spent = min_seconds;
  if (setting.tolerance > 0 && timed_seconds > 0) {
    min_seconds = std::numeric_limits<double>::infinity();
    spent = 0;
  }
  while (spent < timed_seconds) {
    const double seconds = simulate(problem, setting, 1, at_end);
    min_seconds = std::min(min_seconds, seconds);
    spent += seconds;
  }
  result.cpu_ms = min_seconds * 1e3;
  return result;
}

/// Computes the errors of states of a problem.
class ErrorMeter {
 public:
  explicit ErrorMeter(const Problem& problem) : length_(problem.length) {
    problem.build(body_);
    simulation_ = std::make_unique<Simulation>(body_);
    scale_ = std::make_unique<ErrorScale>(simulation_->model(), 1);
  }
  const Model& model() const { return simulation_->model(); }

  /// Returns the largest distance between a part in state a and the part in state b, divided by the length of
  /// a body. If the problem has no such length, returns the difference of all coordinates in the norm of
  /// ErrorScale (error_scale.h).
  double position_error(const State& a, const State& b) const {
    if (!a.q.allFinite() || !b.q.allFinite()) return std::numeric_limits<double>::infinity();
    if (length_ == 0) return scale_->norm(a.q - b.q);
    double worst = 0;
    for (const PartModel& part : model().parts())
      if (part.q0 >= 0)
        worst = std::max(worst, (a.q.segment<3>(part.q0) - b.q.segment<3>(part.q0)).norm() / length_);
    return worst;
  }
  /// Returns the largest position_error over the sampled states.
  double error_along(const Outcome& a, const Outcome& b) const {
    double worst = 0;
    for (std::size_t i = 0; i < a.states.size(); ++i)
      worst = std::max(worst, position_error(a.states[i], b.states[i]));
    return worst;
  }
  /// Returns the difference of the velocities at the end, in the norm of ErrorScale with the rates of b.
  double velocity_error(const Outcome& a, const Outcome& b) const {
    return scale_->norm(VecX<double>::Zero(a.end.q.size()), a.end.v - b.end.v, b.end.v);
  }
  /// Returns the largest difference of joint forces, relative to the largest force of b; NaN if b has no
  /// force.
  static double force_error(const Outcome& a, const Outcome& b) {
    const double largest = b.lambda.size() > 0 ? b.lambda.cwiseAbs().maxCoeff() : 0;
    return largest > 0 ? (a.lambda - b.lambda).cwiseAbs().maxCoeff() / largest : kNone;
  }

 private:
  double length_;
  MultiBody body_;
  std::unique_ptr<Simulation> simulation_;
  std::unique_ptr<ErrorScale> scale_;
};

/// Returns whether the motion is one smooth function of time given by the accelerations: all joints are
/// closed, and there are no contacts and no nodes (whose stiffness would limit the steps).
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

/// Simulates with the first of the tolerances finest, 10 finest, 100 finest, ... at which the method
/// succeeds. At smaller tolerances, rounding errors may make the method fail. Throws StepFailure if the
/// method also fails at the first tolerance above 1e-9.
Outcome run_at_finest_tolerance(const Problem& problem, const std::string& method, double finest) {
  constexpr double kCoarsest = 1e-9;
  for (double tolerance = finest;; tolerance *= 10) try {
      return run(problem, {method, tolerance, 0});
    } catch (const StepFailure&) {
      if (tolerance > kCoarsest) throw;
    }
}

/// Computes a reference by a method of reference_methods.h. The selected step is the one whose result agrees
/// best with that of a step of twice its length; shorter steps only add rounding errors.
template <class Method>
Outcome smooth(const Problem& problem, const ErrorMeter& meter) {
  constexpr double kAgree = 1e-14, kFirstStep = 0.0125;
  constexpr int kMaxHalvings = 6;
  MultiBody body;
  problem.build(body);
  const Simulation simulation(body, "rk4");
  Outcome best, previous;
  double min_difference = std::numeric_limits<double>::infinity();
  for (int halving = 0; halving <= kMaxHalvings && min_difference > kAgree; ++halving) {
    const long each = std::max(1L, std::lround(problem.end / kSamples / kFirstStep)) << halving;
    const double h = problem.end / kSamples / static_cast<double>(each);
    Method method(simulation.dynamics(), simulation.state());
    Outcome latest;
    for (long i = 0; i < kSamples * each; ++i) {
      method.step(static_cast<double>(i) * h, h);
      if ((i + 1) % each != 0) continue;
      State& state = latest.states.emplace_back(simulation.state());
      state.q = method.q();
      state.v = method.v();
      normalise_rotations(simulation.model(), state.q);
      latest.gap = std::max(latest.gap, worst_gap(simulation.model(), state));
    }
    const double difference = halving == 0 ? min_difference : meter.error_along(latest, previous);
    previous = latest;
    if (halving > 0 && !(difference < min_difference)) continue;
    min_difference = difference;
    best = latest;
  }
  if (best.states.empty())
    throw std::runtime_error(problem.name + ": no step is short enough for a reference");
  best.end = best.states.back();
  Workspace<double> work;
  simulation.dynamics().accelerations(problem.end, best.end.q, best.end.v, best.end, work);
  best.lambda = work.joints.lambda;
  return best;
}

/// Extrapolates two runs to the step zero, for errors that are proportional to the step. The steps of the
/// second run are half as long.
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

/// Returns the CPU time (ms) at an error of `level`. runs: from coarse to fine. The time is interpolated, in
/// logarithms, between the last run whose error is larger than `level` and the next run. If the errors of all
/// runs are at most `level`, returns the time of the first run. Returns NaN if the last run has a larger
/// error, or if there are no runs.
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
/// Returns the CPU time (ms) of the cheapest run with an error of at most `level`, if the next two finer
/// runs have at most three times the error of this run. Returns NaN if there is no such run.
double cost_of_run(const std::vector<Cost>& runs, double level) {
  double min_cost = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < runs.size(); ++i) {
    bool qualifies = runs[i].error <= level;
    for (std::size_t k = i + 1; k < std::min(i + 3, runs.size()); ++k)
      qualifies = qualifies && runs[k].error <= 3 * runs[i].error;
    if (qualifies) min_cost = std::min(min_cost, runs[i].cpu_ms);
  }
  return std::isfinite(min_cost) ? min_cost : kNone;
}

/// The results of earlier rounds in a folder.
class Rounds {
 public:
  /// is_measured: whether a problem, by name, is measured now. again: whether the earlier rows are used.
  Rounds(std::string folder, bool again, std::function<bool(const std::string&)> is_measured)
      : folder_(std::move(folder)), again_(again), is_measured_(std::move(is_measured)) {}

  /// Opens a file of the folder for writing. If `again` is true, copies the earlier rows of problems that are
  /// not measured now.
  std::unique_ptr<bench::TableFile> open(const char* name, const std::string& head) const {
    const std::string path = folder_.empty() ? "" : folder_ + name;
    const auto rows = again_ ? bench::read_rows(path, head) : decltype(bench::read_rows(path, head))();
    auto file = std::make_unique<bench::TableFile>(path, head);
    for (const std::vector<std::string>& row : rows)
      if (!is_measured_(row.front())) file->row(row);
    return file;
  }
  /// Reads the times of earlier runs. The cells of a row before the time identify the run.
  void read_runs(const char* name, const std::string& head) {
    if (!again_) return;
    for (const std::vector<std::string>& row : bench::read_rows(folder_ + name, head))
      if (row.size() > kTime && !row[kTime].empty()) min_times_[key(row)] = std::stod(row[kTime]);
  }
  /// Returns the minimum of the time of this run now and in earlier rounds, ms. run: the cells before the
  /// time.
  double min_time(const std::string& run, double cpu_ms) const {
    const auto found = min_times_.find(run);
    return found == min_times_.end() ? cpu_ms : std::min(cpu_ms, found->second);
  }

 private:
  static constexpr std::size_t kTime = 5;  // column of the time
  static std::string key(const std::vector<std::string>& row) {
    std::string key;
    for (std::size_t i = 0; i < kTime; ++i) key += row[i] + ",";
    return key;
  }

  std::string folder_;
  bool again_;
  std::function<bool(const std::string&)> is_measured_;
  std::map<std::string, double> min_times_;
};

/// Compares the cost of auto with the cost of the best single method at each error level. If two successive
/// levels have equal ratios, because the same two runs qualify for both levels, the second level is ignored.
class AutomaticChoice {
 public:
  explicit AutomaticChoice(const Rounds& rounds)
      : file_(rounds.open("precision_auto.csv",
                          "problem,error,auto_cpu_ms_per_s,best_cpu_ms_per_s,best,auto_over_best\n")) {}
  /// Adds the cost of a method at an error. cpu_ms: CPU ms per simulated second; NaN if no run qualifies.
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
      if (!(ratio <= max_ratio_)) {
        max_ratio_ = ratio;
        worst_ = name;
      }
    }
    automatic_.clear();
    best_.clear();
  }
  void print_summary() const {
    std::printf("auto over the best method: %.2f in the geometric mean over %d levels, %.2f at most (%s)\n",
                std::exp(sum_ / std::max(1, count_)), count_, max_ratio_, worst_.c_str());
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

  std::map<double, double> automatic_;  // CPU ms of auto per simulated s, at each error
  std::map<double, Best, std::greater<>> best_;
  double sum_ = 0, max_ratio_ = 0;
  int count_ = 0;
  std::string worst_, missed_;
};

/// Returns the settings of a method, the coarsest first.
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
  if (problems.empty()) throw std::invalid_argument("unknown problem: " + only);
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
  AutomaticChoice choices(rounds);
  constexpr double kLevels[] = {1e-2, 1e-4, 1e-6, 1e-8, 1e-10}, kResolved = 100, kAgreement = 1e-6;
  constexpr std::size_t kMinSettings = 6;
  const double max_ms = all ? 16e3 : 4e3, timed_seconds = 0.05;
  std::vector<std::string> methods{kAutomatic};
  for (const IntegratorInfo& info : all_integrators()) methods.emplace_back(info.name);
  methods.insert(std::find(methods.begin(), methods.end(), kFixed) + 1, kControlled);

  for (const Problem& problem : problems) {
    const ErrorMeter meter(problem);
    const bool touches = meter.model().body().contact.active;
    constexpr long steps = 1L << 17;  // number of steps of rk4 for problems with contact
    Outcome exact, other;
    if (is_smooth(problem)) {
      exact = smooth<bench::Collocation>(problem, meter);
      other = smooth<bench::Extrapolation>(problem, meter);
    } else if (touches) {
      exact = run_at_finest_tolerance(problem, "dop853", 1e-10);
      other = limit_of(run(problem, {"rk4", 0, steps}), run(problem, {"rk4", 0, 2 * steps}), meter.model());
    } else {
      exact = run_at_finest_tolerance(problem, "dop853", 1e-12);
      other = run_at_finest_tolerance(problem, "dormand_prince", 1e-11);
    }
    exact.end = exact.states.back();
    other.end = other.states.back();
    const double difference = meter.error_along(other, exact),
                 difference_v = meter.velocity_error(other, exact),
                 difference_lambda = ErrorMeter::force_error(other, exact);
    for (const double largest : {difference, difference_v, difference_lambda})
      if (largest > kAgreement || std::isnan(difference) || std::isnan(difference_v))
        throw std::runtime_error(problem.name + ": the references differ by " + std::to_string(largest));
    std::printf("%s: the two references differ by %.1e, velocities by %.1e, forces by %.1e; gap %.1e m\n",
                problem.name.c_str(), difference, difference_v, difference_lambda, exact.gap);
    for (std::size_t i = 0; i < meter.model().parts().size(); ++i) {
      const int q0 = meter.model().parts()[i].q0;
      if (q0 < 0) continue;
      const VecX<double>& q = exact.end.q;
      reference_file->row("%s,%zu,%g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.15g,%.3e,%.3e\n",
                          problem.name.c_str(), i, problem.end, q[q0], q[q0 + 1], q[q0 + 2], q[q0 + 3],
                          q[q0 + 4], q[q0 + 5], q[q0 + 6], difference, exact.gap);
    }
    for (const std::string& method : methods) {
      const bool controlled = method == kAutomatic || method == kControlled ||
                              (make_integrator(method)->error_order() > 0 && method != kFixed);
      std::vector<Cost> points;
      for (const Setting& setting :
           settings_of(method == kControlled ? kFixed : method, controlled, problem.end)) {
        const double requested =
            controlled ? setting.tolerance : problem.end / static_cast<double>(setting.steps);
        Outcome outcome;
        try {
          outcome = run(problem, setting, timed_seconds);
        } catch (const StepFailure&) {
          runs_file->row("%s,%s,%g,,,,,,,,,,,,1,%.3e,%.3e,%.3e\n", problem.name.c_str(), method.c_str(),
                         requested, difference, difference_v, difference_lambda);
          continue;
        }
        char key[160];
        std::snprintf(key, sizeof key, "%s,%s,%g,%ld,%ld,", problem.name.c_str(), method.c_str(), requested,
                      outcome.steps, outcome.evaluations);
        outcome.cpu_ms = rounds.min_time(key, outcome.cpu_ms);
        // An error smaller than the uncertainty of the reference cannot be resolved.
        auto resolved = [](double error, double uncertainty) {
          return std::max(error, kResolved * uncertainty);
        };
        const double error = resolved(meter.position_error(outcome.end, exact.end), difference),
                     error_along = resolved(meter.error_along(outcome, exact), difference);
        points.push_back({outcome.cpu_ms, error});
        runs_file->row("%s%.4f,%.4f,%.3e,%.3e,%.3e,%.3e,%.3e,%.3e,%.3e,0,%.3e,%.3e,%.3e\n", key,
                       outcome.cpu_ms, outcome.cpu_ms / problem.end, error, error_along,
                       resolved(meter.velocity_error(outcome, exact), difference_v),
                       resolved(ErrorMeter::force_error(outcome, exact), difference_lambda), outcome.gap,
                       outcome.balance, outcome.kinetic, difference, difference_v, difference_lambda);
        std::printf("  %-20s %9.3g  %8ld steps  %9.2f ms  error %.2e, along %.2e\n", method.c_str(),
                    requested, outcome.steps, outcome.cpu_ms, error, error_along);
        std::fflush(stdout);
        const bool resolution_reached = error <= kResolved * difference || error < 1e-11;
        if (points.size() >= kMinSettings && (outcome.cpu_ms > max_ms || resolution_reached)) break;
      }
      std::printf("  %-20s CPU ms per simulated s (of one run) at error", method.c_str());
      for (const double level : kLevels) {
        const double interpolated = cost_at(points, level) / problem.end,
                     cost_of_one = cost_of_run(points, level) / problem.end;
        std::printf("  %g: %.3g (%.3g)", level, interpolated, cost_of_one);
        cost_file->row("%s,%s,%g,%.4g,%.4g\n", problem.name.c_str(), method.c_str(), level, interpolated,
                       cost_of_one);
        choices.add(method, level, cost_of_one);
      }
      std::printf("\n");
    }
    choices.end_problem(problem.name);
  }
  choices.print_summary();
  return 0;
} catch (const std::exception& fault) {
  std::fprintf(stderr, "%s\n", fault.what());
  return 1;
}
