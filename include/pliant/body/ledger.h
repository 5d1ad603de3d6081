// The energy ledger and the momenta of a state (design section 5, promise 4).
#pragma once

#include <pliant/body/state.h>

namespace pliant {

struct Ledger {
  /// Energies, J; elastic: of the global parameters, local: of local deformation.
  double kinetic = 0, gravity = 0, elastic = 0, local = 0, springs = 0;
  Vec<double, kWorks> work = Vec<double, kWorks>::Zero();  ///< work so far, J
  Vec3<double> momentum = Vec3<double>::Zero();            ///< P, kg m/s, world
  Vec3<double> angular_momentum = Vec3<double>::Zero();    ///< L about the world's origin, kg m^2/s
  double balance = 0;  ///< energy - energy at the start - work: zero but for the step's error

  double energy() const { return kinetic + gravity + elastic + local + springs; }
};

}  // namespace pliant
