// What a method's own step did, before contacts.
#pragma once

#include <pliant/body/state.h>

namespace pliant {

struct FreeMotion {
  State before;      ///< at its start
  double begin = 0;  ///< s
  double h = 0;      ///< how long it is, s
  double reach = 0;  ///< how far a force moves a body in it, in h^2 times its acceleration (Integrator)
  /// Speeds below this are none, m/s: what rests has been given as much by rounding, and by gravity in a part
  /// of a step.
  double slow = 0;
  double loose =
      0;  ///< and what rests is no faster than this, m/s: impulses left as much (State::contact_residual)

  double end() const { return begin + h; }
  /// Impulses at its end that stand for forces over all of it move bodies by their change of velocity times
  /// this, s.
  double held() const { return reach * h; }
};

}  // namespace pliant
