// Semi-implicit Euler, the paper's method (section 4), first order:
//   v <- v + h vdot(q, v),   q <- q (+) h v
// What oscillates freely does so exactly after the kick by the rest of vdot.
#pragma once

#include <pliant/integrate/free_oscillation.h>
#include <pliant/integrate/integrator.h>

namespace pliant {

class SemiImplicitEuler final : public Integrator {
 public:
  const char* name() const override { return "semi_implicit_euler"; }
  int order() const override { return 1; }
  double reach() const override { return 1; }
  void step(const Dynamics& dynamics, State& state, Workspace<double>& work, StepCounters& counters) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;

 private:
  FreeOscillation free_;
  // Coordinates at the end of a step and their joints, kept between steps: no heap in a step.
  VecX<double> q_end_;
  Workspace<double> ahead_;
};

}  // namespace pliant
