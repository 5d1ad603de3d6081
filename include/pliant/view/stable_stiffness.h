// Bounds of the stiffness of springs and parameters with which fixed explicit steps remain stable.
#pragma once

#include <pliant/simulate/simulation.h>

namespace pliant {

/// Inverse of the effective mass at a point, 1/kg: the largest change of the velocity of the point along a
/// unit impulse, over all directions.
struct InverseMass {
  double frame;  ///< if only the frame and the global parameters of the part move
  double local;  ///< if only its local coordinates move
  double total() const { return frame + local; }
};
/// Returns the inverse of the effective mass at a point of a moving part without its joints. The point may
/// have a patch of nodes.
InverseMass inverse_mass(const Simulation& simulation, const Point& point);
/// Returns the change of the rate of dynamic parameter number k of a part by a unit impulse, without joints:
/// 1/kg for a length, else 1/(kg m^2).
double inverse_mass(const Simulation& simulation, const Part& part, int k);

/// Constants of a spring and damper, N/m and N s/m.
struct SpringConstants {
  double stiffness, damping;
};

/// Bounds for the fixed steps of one scene.
class StableStiffness {
 public:
  /// simulation: at its start. step: fixed step, s; 0 if steps adapt to a tolerance, and then nothing is
  /// bounded.
  StableStiffness(const Simulation& simulation, double step);

  /// Returns constants with which the steps resolve the motion of the frame and the global parameters. Each
  /// constant is at most the wanted constant.
  SpringConstants resolved(const SpringConstants& wanted, const InverseMass& inverse_mass) const;
  /// Returns the largest constants, at most the wanted constants, with which the steps remain stable. A
  /// damping that must be reduced becomes half of the largest stable damping; the stiffness is then as large
  /// as possible. inverse_mass: sum of the inverse effective masses on which the spring acts, 1/kg.
  SpringConstants bounded(const Integrator& method, const SpringConstants& wanted, double inverse_mass) const;

 private:
  double step_;
  double present_ = 0;  // estimated K (stiffness / effective mass) of the fastest motion of the scene at time
                        // 0, 1/s^2; at most 3/4 of the largest stable K
};

}  // namespace pliant
