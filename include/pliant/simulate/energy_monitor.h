// The scale of the error of the energy balance: the energy that has moved in a simulation.
#pragma once

#include <array>
#include <limits>

#include <pliant/body/ledger.h>
#include <pliant/body/model.h>

namespace pliant {

/// The range of the energies of the ledgers of a simulation. A resumed run continues from it.
struct EnergyRange {
  /// Kinds of potential energy: gravity, parameters, local deformation, springs.
  static constexpr std::size_t kPotentials = 4;
  std::array<double, kPotentials> lowest, highest;  ///< of each kind of potential energy, J
  double kinetic = 0;                               ///< largest kinetic energy, J
  double work = 0;                                  ///< largest sum of the magnitudes of all works, J
  double balance = 0;                               ///< largest |Ledger::balance|, J

  EnergyRange() {
    lowest.fill(std::numeric_limits<double>::infinity());
    highest.fill(-std::numeric_limits<double>::infinity());
  }
};

/// Compares the error of the energy balance with the energy that moved: the largest kinetic energy, plus the
/// range of each potential energy, plus the magnitudes of all works.
class EnergyMonitor {
 public:
  explicit EnergyMonitor(const Model& model);

  /// Includes a ledger.
  void add(const Ledger& ledger);
  /// Returns the energy that moved, J. It is at least the energy that lifts every part by a hundredth of its
  /// size, and at least 1e-9 of the largest potential energy: below these the errors of resting contact and
  /// of rounding are not errors of the motion.
  double moved() const;
  /// Returns the largest error of the balance as a share of the energy that moved, from 0 to about 1. The
  /// share is 1 if an energy is not finite.
  double share() const;

  const EnergyRange& range() const { return range_; }
  void set_range(const EnergyRange& range) { range_ = range; }

 private:
  double lift_ = 0;  ///< the energy that lifts every part by a hundredth of its size, J
  EnergyRange range_;
};

}  // namespace pliant
