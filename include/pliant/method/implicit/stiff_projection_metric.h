// The metric of the projection after an implicit step. In the mass metric a projection would displace stiff
// parameters as much as soft parameters. The elastic forces of this displacement would grow without bound
// with the stiffness. For parts without local deformation, (c beta + c^2) K_s is therefore added to the block
// of q_s in M. K_s is the stiffness of the parameters, beta the coefficient of K_s in their damping, and
// c = gamma h of the stages. Stiff parameters then respond to impulses as in a step. The linear and the
// angular momentum do not change.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// While the object exists, impulses on parts act in this metric. If the state is not finite, the metric does
/// not change.
class StiffProjectionMetric {
 public:
  /// work: the evaluation of the last stage. state: the state at time t (s). c: gamma h of the stages, s.
  StiffProjectionMetric(const Dynamics& dynamics, double t, double c, const State& state,
                        Workspace<double>& work);
  ~StiffProjectionMetric() { end(); }
  StiffProjectionMetric(const StiffProjectionMetric&) = delete;
  StiffProjectionMetric& operator=(const StiffProjectionMetric&) = delete;

 private:
  /// Restores the mass metric.
  void end();

  Workspace<double>& work_;
};

}  // namespace pliant
