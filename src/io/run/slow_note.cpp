#include <pliant/io/run/slow_note.h>

#include <pliant/io/format/number_text.h>

namespace pliant {
namespace {

constexpr const char* kText = "the run has hardly advanced: ";

/// Returns a remedy, which depends on the cause of the short steps.
std::string remedy_of(const Simulation& simulation, const SlowProgress& slow) {
  if (simulation.tolerance() == 0) return "Choose a shorter step.";
  if (slow.impacts > 0)
    return "Impacts follow each other ever faster. Choose a smaller restitution, \"step\" in place of "
           "\"tolerance\", or more room between the bodies.";
  return "Choose a larger tolerance, the method \"esdirk\", or slower loads and softer springs.";
}

}  // namespace

std::string slow_progress_note(const Simulation& simulation) {
  if (!simulation.slow_progress()) return {};
  const SlowProgress& slow = *simulation.slow_progress();
  return "warning: at t = " + rounded_text(slow.time) + " s " + kText + count_text(slow.steps, "step") +
         " advanced by " + rounded_text(slow.advance) + " s, with " +
         count_text(slow.rejected, "rejected step") + ", " + count_text(slow.impacts, "located impact") +
         " and " + count_text(slow.evaluations, "evaluation") + " of the accelerations; " + slow.fastest +
         " changes most. " + remedy_of(simulation, slow);
}

bool is_slow_progress_note(const std::string& note) {
  return note.find(kText) != std::string::npos;
}

}  // namespace pliant
