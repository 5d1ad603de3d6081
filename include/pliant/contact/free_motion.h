// The motion of a method without contacts.
#pragma once

#include <pliant/body/state.h>

namespace pliant {

struct FreeMotion {
  State before;      ///< at its start
  double begin = 0;  ///< s
  double h = 0;      ///< length, s
  double reach = 0;  ///< displacement by a constant force, in h^2 times the acceleration (Integrator::reach)
  /// Speeds below this count as zero, m/s: rounding, and gravity in a part of a step, give resting bodies as
  /// much.
  double slow = 0;
  double loose = 0;  ///< largest speed of a resting contact, m/s (State::contact_residual)

  double end() const { return begin + h; }
  /// Impulses at the end that act as forces over the whole motion displace bodies by their change of velocity
  /// times this, s.
  double held() const { return reach * h; }
};

}  // namespace pliant
