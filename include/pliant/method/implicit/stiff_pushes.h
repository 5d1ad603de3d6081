// What brings a state onto its joints and limits after a step of an implicit method: in the mass metric it
// would move stiff parameters as easily as all others, off their balance by an error of the step, which their
// stiffness turns into forces without bound. In the metric M + c D + c^2 K, c of the stages, of the q_s of
// parts without local deformation, it moves them as they move in a step; what that adds to C_q^T lambda acts
// on q_s alone, and leaves P and L as they are.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// While it lives, pushes on parts act in that metric.
class StiffPushes {
 public:
  /// work: of the last stage, which ends at the state, at time t (s).
  StiffPushes(const Dynamics& dynamics, double t, double c, const State& state, Workspace<double>& work);
  ~StiffPushes() { end(); }
  StiffPushes(const StiffPushes&) = delete;
  StiffPushes& operator=(const StiffPushes&) = delete;

 private:
  void end();

  Workspace<double>& work_;
};

}  // namespace pliant
