// Semi-implicit Euler, the method of the paper (section 4), of first order:
//   v <- v + h vdot(q, v),   q <- q (+) h v
// Free oscillators are integrated exactly. Angular momenta rotate with their parts (carry_momenta.h); with
// the first-order gyroscopic term tumbling parts would gain energy without bound.
#pragma once

#include <pliant/method/free_stages.h>
#include <pliant/method/integrator.h>
#include <pliant/project/project.h>

namespace pliant {

class SemiImplicitEuler final : public Integrator {
 public:
  const char* name() const override { return "semi_implicit_euler"; }
  int order() const override { return 1; }
  double reach() const override { return 1; }
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;

 private:
  FreeStages free_;
  // Kept between steps, so that a step allocates no memory.
  VecX<double> v_before_;  ///< velocities at the start of the step
  PreStepStorage pre_step_;
};

}  // namespace pliant
