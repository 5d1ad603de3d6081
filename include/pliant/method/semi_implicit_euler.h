// Semi-implicit Euler, the method of the paper (section 4, after Eq. (14)), of first order:
//   v <- v + h v_dot(t, q, v),   q <- q (+) h v
// (+) adds positions, parameters and local coordinates, and turns rotations by the exponential map. Free
// oscillators (free_oscillation.h) are integrated exactly. The gyroscopic term acts as an exact rotation of
// angular momenta (carry_momenta.h): integrated to first order in h, this term would let tumbling parts gain
// energy without bound.
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
