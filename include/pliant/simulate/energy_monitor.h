// The scale of the error of the energy balance: the energy that could move in a simulation.
#pragma once

#include <pliant/body/ledger.h>
#include <pliant/body/model.h>

namespace pliant {

/// Compares the error of the energy balance with the energy that could move: the kinetic energy at the start,
/// plus the potential energy at the start above its lowest value, plus the magnitudes of all works. The
/// kinetic energy of a motion without error is at most this energy. The kinetic energy after the start does
/// not count, so that an error that grows hardly changes this energy.
class EnergyMonitor {
 public:
  explicit EnergyMonitor(const Model& model);

  /// Includes the ledger of a state at time t (s). The first call must be for the state at the start.
  void add(const Ledger& ledger, double t);
  /// Returns the energy that could move, J. This energy is at least the energy that lifts every part by a
  /// hundredth of its size, and at least 1e-9 of the largest potential energy. Resting contact and rounding
  /// cause errors below these bounds, which are not errors of the motion.
  double movable() const;
  /// Returns the largest error of the balance as a share of the energy that could move. The share is 0 if
  /// nothing has moved: if the sum of works and kinetic energy is below the kinetic energy of parts that move
  /// by 1e-5 of their size in the time so far. The share is infinite if an energy is not finite.
  double share() const;

  double max_kinetic() const { return kinetic_; }  ///< largest kinetic energy, J
  double max_error() const { return error_; }      ///< largest |Ledger::balance|, J

 private:
  double lift_ = 0;    ///< the energy that lifts every part by a hundredth of its size, J
  double second_ = 0;  ///< sum of the masses times the squares of the sizes, kg m^2
  bool started_ = false;
  double start_kinetic_ = 0, kinetic_ = 0, work_ = 0, error_ = 0, time_ = 0;
  double start_potential_ = 0, lowest_potential_ = 0;  ///< of the sum of the potential energies, J
  double largest_term_ = 0;                            ///< largest magnitude of one potential energy, J
};

}  // namespace pliant
