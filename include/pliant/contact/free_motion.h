// A motion: one step of the method of integration, without contact impulses.
#pragma once

#include <pliant/body/state.h>

namespace pliant {

struct FreeMotion {
  State before;      ///< state at the start
  double begin = 0;  ///< time of the start, s
  double h = 0;      ///< length, s
  double reach = 0;  ///< a constant acceleration a displaces by reach * a * h^2 (Integrator::reach)
  /// An impact rebounds only if its rebound is faster than this, m/s. Rounding and gravity within a fraction
  /// of a step cause slower impacts.
  double min_impact_speed = 0;
  /// Largest normal speed of a resting contact, m/s. It includes the residual of the last impulses
  /// (State::contact_residual).
  double max_resting_speed = 0;

  double end() const { return begin + h; }
  /// Returns a time, s. Impulses at the end of the motion that stand for forces constant during the motion
  /// displace bodies by this time multiplied by the change of velocity.
  double force_time() const { return reach * h; }
};

}  // namespace pliant
