// The two-stage Rosenbrock method ROS2 (Verwer, Spee, Blom & Hundsdorfer 1999) on (q, v, work):
//   (I - gamma h A) k1 = F(u),   (I - gamma h A) k2 = F(u + h k1) - 2 k1,   u+ = u + 3/2 h k1 + 1/2 h k2
// It is of second order for every A, and L-stable if A is the Jacobian, with gamma = 1 - 1/sqrt(2). A
// contains q_dot = v for all coordinates, which makes free oscillations neither grow nor decay for h omega
// < 2.26. For parts that deform locally A also contains the elasticity and damping of their nodes or modes
// and of their global parameters (method/implicit/implicit_part.h). Everything else is explicit. The
// first-order solution u + h k1 estimates the error.
//
// An impact on a stiff part needs the velocities of its actual motion, which the stiff velocities of ROS2 are
// not. If parts that deform locally may touch, or if a string or a limit stops one of them, the step is one
// of linearly implicit Euler: gamma = 1 and u+ = u + h k1, of first order. Then x+ = x + h v+, impulses
// change v+ by (I - h A)^-1 M^-1 and x+ by h times that, and their work is that of an inelastic impact.
#pragma once

#include <memory>
#include <vector>

#include <pliant/method/integrator.h>

namespace pliant {

class ImplicitPart;

class LinearlyImplicit final : public Integrator {
 public:
  LinearlyImplicit();
  ~LinearlyImplicit() override;
  const char* name() const override { return "linearly_implicit"; }
  int order() const override { return 2; }
  int error_order() const override { return 1; }
  /// Throws NumericalFailure or OutOfMemory, naming the part, if the stiffness of its nodes cannot be
  /// factored.
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;
  bool local_is_implicit() const override { return true; }
  double reach() const override { return touching_ ? 1 : 0.5; }
  void expect_touch(bool touching) override { touching_ = touching; }
  void set_responses(const Model& model, bool on, Workspace<double>& work) const override;

 private:
  /// One entry for each part; nullptr for an explicit part.
  using Soft = std::vector<std::unique_ptr<ImplicitPart>>;
  /// Returns the implicit parts of the current step.
  Soft& soft() { return first_order_ ? of_first_ : of_second_; }
  const Soft& soft() const { return first_order_ ? of_first_ : of_second_; }
  /// Prepares the implicit parts for a stage with this c = gamma h, s.
  void prepare_implicit_parts(StepContext& step, double c);
  void filter(const Model& model, const Workspace<double>& work, const VecX<double>& q_dot,
              VecX<double>& v_dot);
  void second_order(StepContext& step);
  void first_order(StepContext& step);
  void end_step(StepContext& step);
  void record_slack_strings(const Model& model, const State& state, const Workspace<double>& work);
  bool was_stopped(const Model& model, const State& now) const;

  bool touching_ = false, first_order_ = false, loose_ = false;
  // Kept between steps, so that a step allocates no memory. Factors depend on model, step and state only.
  Soft of_second_, of_first_;   ///< for steps of second and of first order
  State before_;                ///< to repeat the step from
  Workspace<double> filtered_;  ///< parts with the metric of the filter
  VecX<double> q_, v_, q_dot_, q_rate1_, v_rate1_, q_rate2_, v_rate2_;
};

}  // namespace pliant
