// Function bodies of energy_monitor.h.
#pragma once

#include <pliant/simulate/energy_monitor.h>

#include <algorithm>
#include <cmath>

#include <pliant/math/header_only.h>

namespace pliant {

namespace energy_monitor {
/// Share of its size by which every part is lifted, and share of the largest potential energy, in the
/// smallest energy that moves.
inline constexpr double kLift = 0.01, kRounding = 1e-9;
}  // namespace energy_monitor

PLIANT_INLINE EnergyMonitor::EnergyMonitor(const Model& model) {
  const double gravity = model.body().gravity_at(0).norm();
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) lift_ += energy_monitor::kLift * gravity * m.part->total_mass() * m.part->size();
}

PLIANT_INLINE void EnergyMonitor::add(const Ledger& ledger) {
  const std::array<double, EnergyRange::kPotentials> potentials{ledger.gravity, ledger.elastic, ledger.local,
                                                                ledger.springs};
  for (std::size_t k = 0; k < potentials.size(); ++k) {
    range_.lowest[k] = std::min(range_.lowest[k], potentials[k]);
    range_.highest[k] = std::max(range_.highest[k], potentials[k]);
  }
  range_.kinetic = std::max(range_.kinetic, ledger.kinetic);
  range_.work = std::max(range_.work, ledger.work.lpNorm<1>());
  range_.balance = std::max(range_.balance, std::abs(ledger.balance));
}

PLIANT_INLINE double EnergyMonitor::moved() const {
  double sum = range_.kinetic + range_.work, largest = 0;
  for (std::size_t k = 0; k < EnergyRange::kPotentials; ++k) {
    if (!(range_.lowest[k] <= range_.highest[k])) continue;  // no ledger yet
    sum += range_.highest[k] - range_.lowest[k];
    largest = std::max({largest, std::abs(range_.lowest[k]), std::abs(range_.highest[k])});
  }
  return std::max({sum, lift_, energy_monitor::kRounding * largest});
}

PLIANT_INLINE double EnergyMonitor::share() const {
  if (range_.balance == 0) return 0;
  const double ratio = range_.balance / moved();
  return std::isfinite(ratio) ? ratio : 1;
}

}  // namespace pliant
