// The two-stage Rosenbrock method ROS2 (Verwer, Spee, Blom & Hundsdorfer 1999) on (q, v, work):
//   (I - gamma h A) k1 = F(u),   (I - gamma h A) k2 = F(u + h k1) - 2 k1,   u+ = u + 3/2 h k1 + 1/2 h k2
// of second order whatever A is, and L-stable where A is the Jacobian, with gamma = 1 - 1/sqrt(2). A holds
// q_dot = v for all coordinates, which costs nothing and makes what swings freely neither grow nor die for h
// omega < 2.26, and of parts that deform locally the elasticity and damping of their nodes or modes
// and of their global parameters (src/integrate/implicit_part.h). Everything else is explicit. Its error is
// estimated by u + h k1, of first order.
#pragma once

#include <memory>
#include <vector>

#include <pliant/integrate/integrator.h>

namespace pliant {

class ImplicitPart;

class LinearlyImplicit final : public Integrator {
 public:
  LinearlyImplicit();
  ~LinearlyImplicit() override;
  const char* name() const override { return "linearly_implicit"; }
  int order() const override { return 2; }
  int error_order() const override { return 1; }
  /// Throws NumericalFailure and OutOfMemory, naming the part, where the stiffness of its nodes cannot be
  /// factored.
  void step(const Dynamics& dynamics, State& state, Workspace<double>& work, StepCounters& counters) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;
  bool local_is_implicit() const override { return true; }

 private:
  void take_soft(const Dynamics& dynamics, double t, double c, const Workspace<double>& work,
                 StepCounters& counters);
  void filter(const Model& model, const Workspace<double>& work, const VecX<double>& q_dot,
              VecX<double>& v_dot);

  // Kept between steps: no heap in a step. Factors depend on the model, the step and the state only.
  std::vector<std::unique_ptr<ImplicitPart>> soft_;  ///< of each part; none where nothing is implicit
  Workspace<double> filtered_;                       ///< parts by what pushes do to their rates
  VecX<double> q_, v_, q_dot_, q_rate1_, v_rate1_, q_rate2_, v_rate2_;
};

}  // namespace pliant
