#include <pliant/io/run/energy_gate.h>

#include <cmath>
#include <sstream>

#include <pliant/io/format/number_text.h>
#include <pliant/simulate/failure_report.h>

namespace pliant {
namespace {

constexpr const char* kNote = "the largest error of the energy balance is ";

std::string percent(double share) {
  return rounded_text(100 * share) + " %";
}

}  // namespace

void require_energy_balance(const Simulation& simulation, const EnergyMonitor& monitor, const State& before) {
  if (!(monitor.share() > kLargestEnergyShare)) return;
  const double error = monitor.max_error();
  std::ostringstream message;
  message << "at t = " << rounded_text(simulation.time()) << " s, in steps of "
          << rounded_text(simulation.state().h) << " s, ";
  if (std::isfinite(error))
    message << "the energies have changed by " << rounded_text(error) << " J more than the works, which is "
            << percent(monitor.share()) << " of the energy that could move (at most "
            << percent(kLargestEnergyShare) << "): ";
  else
    message << "the energies are not finite: ";
  message << failure_report::largest_energy_change(simulation.dynamics(), before, simulation.state());
  throw NumericalFailure(message.str(), simulation.time());
}

bool is_of_first_order(const Simulation& simulation) {
  return simulation.tolerance() == 0 && simulation.integrator().order() == 1;
}

std::string energy_note(const Simulation& simulation, const EnergyMonitor& monitor) {
  const Integrator& method = simulation.integrator();
  const double share = monitor.share();
  const bool first_order = is_of_first_order(simulation);
  if (share == 0 || (share <= kReportedEnergyShare && !first_order)) return {};
  const std::string error = std::string(kNote) + rounded_text(monitor.max_error()) + " J, which is " +
                            percent(share) + " of the energy that could move (" +
                            rounded_text(monitor.movable()) + " J). ",
                    order = std::string("The method ") + method.name() + " is of order " +
                            std::to_string(method.order()) + ".";
  if (share <= kReportedEnergyShare) return error + order;
  const std::string warning = "warning: " + error;
  if (simulation.tolerance() > 0)
    return warning + "Choose a smaller tolerance than " + rounded_text(simulation.tolerance()) + ".";
  const double h = simulation.state().h;
  return warning + order + " Choose " +
         (first_order ? "a step of about " + rounded_text(h * kReportedEnergyShare / share, 2)
                      : "a smaller step than " + rounded_text(h)) +
         " s, or \"integrator\": \"auto\" with a tolerance.";
}

bool is_energy_note(const std::string& note) {
  return note.find(kNote) != std::string::npos;
}

}  // namespace pliant
