// The implicit midpoint rule on (q, v, work), of second order: y+ = y + h f((y + y+) / 2). The rule conserves
// quadratic invariants of (q, v). For a free rigid body, these are the energy and the magnitude of the
// angular momentum. Quaternions keep unit length. The method is A-stable and does not damp fast oscillations.
#pragma once

#include <memory>

#include <pliant/method/integrator.h>

namespace pliant {

class StageSolver;

class ImplicitMidpoint final : public Integrator {
 public:
  ImplicitMidpoint();
  ~ImplicitMidpoint() override;
  const char* name() const override { return "implicit_midpoint"; }
  int order() const override { return 2; }
  /// Throws NumericalFailure if the iteration of the step does not converge, or if a matrix would be too
  /// large (StageSolver::solve).
  void step(StepContext& step) override;
  Eigen::Index max_velocities() const override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;

 private:
  std::unique_ptr<StageSolver> solver_;
  std::unique_ptr<ErrorScale> stage_scale_;  ///< scale of the changes of the iteration
  VecX<double> q_, v_, q_dot_;
};

}  // namespace pliant
