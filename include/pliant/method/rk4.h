// The classical Runge-Kutta method of fourth order (Kutta 1901) on (q, v, work). Quaternions are integrated
// as four numbers by theta_dot = 1/2 theta o (0, omega) and normalised after the step, which keeps the order.
// Free oscillators (free_oscillation.h) are integrated exactly.
#pragma once

#include <pliant/method/free_stages.h>
#include <pliant/method/integrator.h>

namespace pliant {

class Rk4 final : public Integrator {
 public:
  const char* name() const override { return "rk4"; }
  int order() const override { return 4; }
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;

 private:
  FreeStages free_;
  VecX<double> q_, v_, q_dot_, q_sum_, v_sum_;  // kept between steps, so that a step allocates no memory
};

}  // namespace pliant
