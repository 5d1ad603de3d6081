// The energy ledger and the momenta of a state. The energy minus the energy at the start equals the work so
// far, within the error of the steps.
#pragma once

#include <pliant/body/state.h>

namespace pliant {

struct Ledger {
  double kinetic = 0;  ///< kinetic energy, J
  double gravity = 0;  ///< potential energy of gravity, J
  double elastic = 0;  ///< elastic energy of the global parameters, J
  double local = 0;    ///< elastic energy of local deformation, J
  double springs = 0;  ///< elastic energy of springs and passive drives, J
  Vec<double, kWorks> work = Vec<double, kWorks>::Zero();  ///< work so far, J, by kind (enum Work)
  Vec3<double> momentum = Vec3<double>::Zero();            ///< linear momentum P, kg m/s, world
  Vec3<double> angular_momentum = Vec3<double>::Zero();    ///< L about the origin of the world, kg m^2/s
  double balance = 0;  ///< energy - energy at the start - work, J: the error of the steps

  double energy() const { return kinetic + gravity + elastic + local + springs; }
};

}  // namespace pliant
