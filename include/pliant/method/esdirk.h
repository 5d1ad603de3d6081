// The ESDIRK method of order 4 by Kennedy and Carpenter (Appl. Numer. Math. 44, 2003: the implicit part of
// ARK4(3)6L[2]SA), on (q, v, work): singly diagonally implicit, explicit first stage, L-stable, stiffly
// accurate. Limits, strings and closed joints are projected after the step. An embedded method of order 3
// estimates the error. The implicit stages share one matrix. The matrix is computed only if the motion is
// stiff, and computed again if a stage does not converge.
#pragma once

#include <memory>
#include <vector>

#include <pliant/method/integrator.h>

namespace pliant {

class StageSolver;

class Esdirk final : public Integrator {
 public:
  Esdirk();
  ~Esdirk() override;
  const char* name() const override { return "esdirk"; }
  int order() const override { return 4; }
  int error_order() const override { return 3; }
  /// Throws NumericalFailure if the iteration of a stage does not converge, or if a matrix would be too large
  /// (StageSolver::solve).
  void step(StepContext& step) override;
  Eigen::Index max_velocities() const override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;

 private:
  std::unique_ptr<StageSolver> solver_;
  std::unique_ptr<ErrorScale> stage_scale_;  ///< scale of the iteration if there is no tolerance
  MatX<double> q_rates_, v_rates_;           ///< one column for each stage
  VecX<double> q_, v_, r_q_, r_v_, q_dot_;
};

}  // namespace pliant
