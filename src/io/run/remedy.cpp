#include <pliant/io/run/remedy.h>

#include <algorithm>
#include <chrono>
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

/// Ratio of a tried step to the previous one, and the smallest tried step as a share of the failed one.
constexpr double kShorter = 0.25, kShortest = 1e-3;
/// Tried tolerances as multiples of the failed one.
constexpr double kTolerances[] = {0.01, 10, 100};

/// Settings of a trial run, and how the advice names them.
struct Trial {
  std::string integrator;
  double step, tolerance;
  std::string name;
};

enum class Outcome { reaches_end, fails, unfinished };

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

  /// Performs a trial. It has the steps of a run, and examines the energies of the states that the run would
  /// record.
  Outcome outcome(const Trial& trial) const {
    try {
      Simulation simulation(scene_.body, trial.integrator, threads_, trial.tolerance);
      const FrameSchedule schedule = trial.tolerance > 0
                                         ? FrameSchedule::with_free_steps(scene_.end, scene_.frame_rate)
                                         : FrameSchedule(scene_.end, trial.step, scene_.frame_rate);
      EnergyMonitor monitor(simulation.model());
      monitor.add(simulation.ledger(), 0);
      while (!at_end(simulation, schedule)) {
        if (over()) return Outcome::unfinished;
        if (!scheduled_step(simulation, schedule)) continue;
        monitor.add(simulation.ledger(), simulation.time());
        if (monitor.share() > kLargestEnergyShare) return Outcome::fails;
      }
      return Outcome::reaches_end;
    } catch (const std::exception&) {  // the advice never replaces the failure of the run
      return Outcome::fails;
    }
  }

 private:
  Scene& scene_;
  int threads_;
  const std::function<bool()>& stop_;
  Clock::time_point deadline_;
};

/// Returns the trials with shorter fixed steps: first the largest stable step, then fractions of the step.
std::vector<Trial> shorter_steps(Scene& scene, const FailedRun& failed) {
  std::vector<double> steps;
  const double stable = 0.9 * stable_step(Simulation(scene.body, failed.integrator, 1, 0)).step;
  if (stable < failed.step) steps.push_back(stable);
  for (double h = kShorter * failed.step; h > kShortest * failed.step; h *= kShorter) steps.push_back(h);
  std::vector<Trial> trials;
  for (const double h : steps)
    trials.push_back(
        {failed.integrator, std::stod(rounded_text(h)), 0, "a step of " + rounded_text(h) + " s"});
  return trials;
}

std::vector<Trial> other_tolerances(const Scene& scene, const FailedRun& failed) {
  std::vector<Trial> trials;
  for (const double factor : kTolerances) {
    const double exact = std::clamp(factor * scene.tolerance, kMinTolerance, kMaxTolerance);
    trials.push_back(
        {failed.integrator, 0, std::stod(rounded_text(exact)), "a tolerance of " + rounded_text(exact)});
  }
  return trials;
}

std::vector<Trial> trials_for(Scene& scene, const FailedRun& failed) {
  std::vector<Trial> trials;
  try {
    trials = failed.step > 0 ? shorter_steps(scene, failed) : other_tolerances(scene, failed);
  } catch (const std::exception&) {  // the stable step cannot be computed
  }
  if (failed.step > 0 || failed.integrator != kAutomatic)
    trials.push_back({kAutomatic, 0, kStandardTolerance, "the integrator auto"});
  return trials;
}

/// Adds a name to a list with commas.
void add_name(std::string& list, const std::string& name) {
  list += (list.empty() ? "" : ", ") + name;
}

}  // namespace

std::string find_remedy(Scene& scene, const FailedRun& failed, double seconds,
                        const std::function<bool()>& stop) {
  const Trials runs(scene, failed.threads, seconds, stop);
  std::string failing, unfinished;
  for (const Trial& trial : trials_for(scene, failed)) {
    if (runs.over()) break;
    const Outcome outcome = runs.outcome(trial);
    if (outcome == Outcome::reaches_end) return trial.name + " reaches the end of the scene";
    add_name(outcome == Outcome::fails ? failing : unfinished, trial.name);
  }
  std::string text = "trials of about " + rounded_text(seconds, 2) + " s found no remedy";
  if (!failing.empty()) text += "; they failed with " + failing;
  if (!unfinished.empty()) text += "; they did not finish with " + unfinished;
  return text;
}

}  // namespace pliant
