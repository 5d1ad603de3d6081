// The singly diagonally implicit Runge-Kutta method of order 4 with an explicit first stage by Kennedy and
// Carpenter (Appl. Numer. Math. 44, 2003: the implicit part of ARK4(3)6L[2]SA), on (q, v, work) with closed
// joints projected: L-stable and stiffly accurate, its error estimated by a method of order 3. All stages
// share one matrix, which is only formed where the motion is stiff.
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
  /// Throws NumericalFailure where the equations of a stage are not solved.
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;

 private:
  std::unique_ptr<StageSolver> solver_;
  std::unique_ptr<ErrorScale> fine_scale_;  ///< where errors are not measured
  MatX<double> q_rates_, v_rates_;          ///< a column a stage
  VecX<double> q_, v_, r_q_, r_v_, q_dot_;
};

}  // namespace pliant
