// The metric of the projection after an implicit step. In the mass metric a projection would move stiff
// parameters as easily as others, and their stiffness would turn this error of the step into unbounded
// forces. In the metric M + c D + c^2 K for the q_s of parts without local deformation (c of the stages),
// they respond as in a step. The difference to C_q^T lambda acts on q_s alone: P and L do not change.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// While the object lives, impulses on parts act in that metric.
class StiffPushes {
 public:
  /// work: of the last stage, at the state and at time t, s.
  StiffPushes(const Dynamics& dynamics, double t, double c, const State& state, Workspace<double>& work);
  ~StiffPushes() { end(); }
  StiffPushes(const StiffPushes&) = delete;
  StiffPushes& operator=(const StiffPushes&) = delete;

 private:
  void end();

  Workspace<double>& work_;
};

}  // namespace pliant
