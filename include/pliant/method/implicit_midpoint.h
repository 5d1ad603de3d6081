// The implicit midpoint rule on (q, v, work), second order: y+ = y + h f((y + y+) / 2). It keeps what is
// quadratic in (q, v): the energy and the angular momentum in its frame of a free rigid body, and with them
// its motion for any number of steps; unit quaternions stay so. Stable for any step where the motion is
// linear, without damping what it cannot follow.
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
  /// Throws NumericalFailure where the equations of the step are not solved.
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;

 private:
  std::unique_ptr<StageSolver> solver_;
  std::unique_ptr<ErrorScale> fine_scale_;
  VecX<double> q_, v_, q_dot_;
};

}  // namespace pliant
