// Function bodies of energy_monitor.h.
#pragma once

#include <pliant/simulate/energy_monitor.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/math/header_only.h>

namespace pliant {

namespace energy_monitor {
/// The smallest values of the energy that could move: kLift, the energy that lifts every part by this share
/// of its size; kRounding, this share of the largest potential energy.
inline constexpr double kLift = 0.01, kRounding = 1e-9;
/// A part that moves by less than this share of its size in the whole time is regarded as motionless.
inline constexpr double kStill = 1e-5;
}  // namespace energy_monitor

PLIANT_INLINE EnergyMonitor::EnergyMonitor(const Model& model) {
  const double gravity = model.body().gravity_at(0).norm();
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    lift_ += energy_monitor::kLift * gravity * m.part->total_mass() * m.size;
    second_ += m.part->total_mass() * m.size * m.size;
  }
}

PLIANT_INLINE void EnergyMonitor::add(const Ledger& ledger, double t) {
  const double potential = ledger.energy() - ledger.kinetic;
  if (!started_) {
    start_kinetic_ = ledger.kinetic;
    start_potential_ = lowest_potential_ = potential;
    started_ = true;
  }
  time_ = std::max(time_, t);
  lowest_potential_ = std::min(lowest_potential_, potential);
  for (const double term : {ledger.gravity, ledger.elastic, ledger.local, ledger.springs})
    largest_term_ = std::max(largest_term_, std::abs(term));
  kinetic_ = std::max(kinetic_, ledger.kinetic);
  work_ = std::max(work_, ledger.work.lpNorm<1>());
  const bool finite = std::isfinite(ledger.energy()) && std::isfinite(ledger.balance);
  error_ = finite ? std::max(error_, std::abs(ledger.balance)) : std::numeric_limits<double>::infinity();
}

PLIANT_INLINE double EnergyMonitor::movable() const {
  return std::max({start_kinetic_ + start_potential_ - lowest_potential_ + work_, lift_,
                   energy_monitor::kRounding * largest_term_});
}

PLIANT_INLINE double EnergyMonitor::share() const {
  if (!std::isfinite(error_)) return error_;
  const double speed = time_ > 0 ? energy_monitor::kStill / time_ : 0,  // in sizes per second
      still = 0.5 * second_ * speed * speed;
  if (error_ == 0 || kinetic_ + work_ <= still) return 0;
  return error_ / movable();
}

}  // namespace pliant
