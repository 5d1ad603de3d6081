#include <pliant/io/run/remedy.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <deque>
#include <optional>
#include <stdexcept>
#include <vector>

#include <pliant/io/format/number_text.h>
#include <pliant/io/run/energy_gate.h>
#include <pliant/io/run/scheduled_step.h>
#include <pliant/simulate/energy_monitor.h>
#include <pliant/simulate/simulation.h>
#include <pliant/simulate/stable_step.h>

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;

/// Trials with fractions of the step of the failed run: ratio of a step to the step before, and bound above
/// which these steps are, as a share of the step of the failed run. Repeated trials may have shorter steps.
constexpr double kShorter = 0.25, kShortest = 1e-3;
/// Tried tolerances as multiples of the tolerance of the failed run.
constexpr double kTolerances[] = {0.01, 10, 100};
/// Largest number of repetitions in all trials together. A trial with a large error of the energy balance is
/// repeated with a shorter step or a smaller tolerance, so that the expected error is kSafety times the
/// largest error without a warning.
constexpr int kMaxRefinements = 3;
constexpr double kSafety = 0.3;

/// Settings of a trial run, and their name in the advice.
struct Trial {
  std::string integrator;
  double step, tolerance;
  std::string name;
};

enum class Outcome { reaches_end, fails, unfinished };

/// The outcome of a trial, and the largest error of its energy balance as a share of the energy that could
/// move (EnergyMonitor).
struct Result {
  Outcome outcome;
  double share = 0;

  bool is_accurate() const { return outcome == Outcome::reaches_end && share <= kReportedEnergyShare; }
};

/// Trial runs of a scene, which end at a common deadline.
class Trials {
 public:
  Trials(Scene& scene, int threads, double seconds, const std::function<bool()>& stop)
      : scene_(scene),
        threads_(threads),
        stop_(stop),
        deadline_(Clock::now() +
                  std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds))) {}

  bool over() const { return Clock::now() > deadline_ || (stop_ && stop_()); }

  /// Performs a trial with the steps of a run. Examines the energies of the states that the run would record
  /// for its frames.
  Result result(const Trial& trial) const {
    try {
      Simulation simulation(scene_.body, trial.integrator, threads_, trial.tolerance,
                            [this] { return over(); });
      const FrameSchedule schedule = trial.tolerance > 0
                                         ? FrameSchedule::with_free_steps(scene_.end, scene_.frame_rate)
                                         : FrameSchedule(scene_.end, trial.step, scene_.frame_rate);
      EnergyMonitor monitor(simulation.model());
      monitor.add(simulation.ledger(), 0);
      while (!at_end(simulation, schedule)) {
        if (over()) return {Outcome::unfinished};
        if (!scheduled_step(simulation, schedule)) continue;
        monitor.add(simulation.ledger(), simulation.time());
        if (monitor.share() > kLargestEnergyShare) return {Outcome::fails};
      }
      return {Outcome::reaches_end, monitor.share()};
    } catch (const ChoiceStopped&) {
      return {Outcome::unfinished};
    } catch (const std::exception&) {  // an exception in a trial must not hide the failure of the run
      return {Outcome::fails};
    }
  }

 private:
  Scene& scene_;
  int threads_;
  const std::function<bool()>& stop_;
  Clock::time_point deadline_;
};

Trial with_step(const std::string& integrator, double step) {
  return {integrator, std::stod(rounded_text(step)), 0, "a step of " + rounded_text(step) + " s"};
}

Trial with_tolerance(const std::string& integrator, double tolerance) {
  const double exact = std::clamp(tolerance, kMinTolerance, kMaxTolerance);
  return {integrator, 0, std::stod(rounded_text(exact)), "a tolerance of " + rounded_text(exact)};
}

/// Returns the trials with shorter fixed steps: first 0.9 times the largest stable step, if this step is
/// shorter than the step of the failed run, then fractions of the step of the failed run.
std::vector<Trial> shorter_steps(Scene& scene, const FailedRun& failed) {
  std::vector<Trial> trials;
  const double stable = 0.9 * stable_step(Simulation(scene.body, failed.integrator, 1, 0)).step;
  if (stable < failed.step) trials.push_back(with_step(failed.integrator, stable));
  for (double h = kShorter * failed.step; h > kShortest * failed.step; h *= kShorter)
    trials.push_back(with_step(failed.integrator, h));
  return trials;
}

std::vector<Trial> other_tolerances(const Scene& scene, const FailedRun& failed) {
  std::vector<Trial> trials;
  for (const double factor : kTolerances)
    trials.push_back(with_tolerance(failed.integrator, factor * scene.tolerance));
  return trials;
}

/// Returns the trials in their order. As in `pliant run --integrator auto`, the trial with "auto" has the
/// tolerance of the scene, or kStandardTolerance if the scene has none.
std::vector<Trial> trials_for(Scene& scene, const FailedRun& failed) {
  std::vector<Trial> trials;
  try {
    trials = failed.step > 0 ? shorter_steps(scene, failed) : other_tolerances(scene, failed);
  } catch (const std::exception&) {  // the stable step cannot be computed
  }
  if (failed.step > 0 || failed.integrator != kAutomatic)
    trials.push_back(
        {kAutomatic, 0, scene.tolerance > 0 ? scene.tolerance : kStandardTolerance, "the integrator auto"});
  return trials;
}

/// Returns a trial whose expected error of the energy balance is small. share: the error of `trial`, as a
/// share of the energy that could move. The error is assumed to be proportional to the tolerance, or to h^p
/// for a method of order p with steps of h seconds.
Trial refined(const Trial& trial, double share) {
  const double ratio = kSafety * kReportedEnergyShare / share;
  if (trial.tolerance > 0) return with_tolerance(trial.integrator, ratio * trial.tolerance);
  return with_step(trial.integrator,
                   trial.step * std::pow(ratio, 1.0 / make_integrator(trial.integrator)->order()));
}

/// Returns the name of a setting that reaches the end, and the error of its energy balance if this error is
/// large.
std::string advice(const Trial& trial, double share) {
  std::string text = trial.name + " reaches the end of the scene";
  if (share > kReportedEnergyShare)
    text += ", but the error of its energy balance is " + rounded_text(100 * share, 2) +
            " % of the energy that could move";
  return text;
}

/// Adds a name to a list with commas.
void add_name(std::string& list, const std::string& name) {
  list += (list.empty() ? "" : ", ") + name;
}

}  // namespace

std::string find_remedy(Scene& scene, const FailedRun& failed, double seconds,
                        const std::function<bool()>& stop) {
  const Trials runs(scene, failed.threads, seconds, stop);
  std::string failing, unfinished, inaccurate;
  double least_share = kInfinity;
  int refinements = 0;
  const std::vector<Trial> trials = trials_for(scene, failed);
  std::deque<Trial> left(trials.begin(), trials.end());
  while (!left.empty() && !runs.over()) {
    const Trial trial = left.front();
    left.pop_front();
    const Result result = runs.result(trial);
    if (result.is_accurate()) return advice(trial, result.share);
    if (result.outcome != Outcome::reaches_end) {
      add_name(result.outcome == Outcome::fails ? failing : unfinished, trial.name);
      continue;
    }
    if (result.share < least_share) {
      least_share = result.share;
      inaccurate = advice(trial, result.share);
    }
    // If "auto" is not the method of the failed run, the trial with "auto" is not repeated with a smaller
    // tolerance. The advice would then be "a tolerance of E", and a user who follows this advice keeps the
    // method of the failed run.
    if (trial.integrator == failed.integrator && refinements++ < kMaxRefinements)
      left.push_front(refined(trial, result.share));
  }
  if (!inaccurate.empty()) return inaccurate;
  std::string text = "trial runs, at most " + rounded_text(seconds, 2) + " s in total, found no remedy";
  if (!failing.empty()) text += "; they failed with " + failing;
  if (!unfinished.empty()) text += "; they did not finish with " + unfinished;
  return text;
}

}  // namespace pliant
