// The two-stage Rosenbrock method ROS2 (Verwer, Spee, Blom & Hundsdorfer 1999) on (q, v, work):
//   (I - gamma h A) k1 = F(u),   (I - gamma h A) k2 = F(u + h k1) - 2 k1,   u+ = u + 3/2 h k1 + 1/2 h k2
// of second order whatever A is, and L-stable where A is the Jacobian, with gamma = 1 - 1/sqrt(2). A holds
// q_dot = v for all coordinates, which costs nothing and makes what swings freely neither grow nor die for h
// omega < 2.26, and of parts that deform locally the elasticity and damping of their nodes or modes
// and of their global parameters (method/implicit/implicit_part.h). Everything else is explicit. Its error is
// estimated by u + h k1, of first order; of such parts in place, for velocities as what they move in a step.
//
// What strikes something stiff needs velocities that are those by which it moved, and the stiff ones of ROS2
// are not. Where parts that deform locally may touch, or a string or a limit that was loose stops one of
// them, a step is of Euler's method instead, gamma = 1 and u+ = u + h k1, of first order: then x+ = x + h v+,
// pushes change v+ by (I - h A)^-1 M^-1 and x+ by h times that, and work as in any inelastic impact.
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
  /// Throws NumericalFailure and OutOfMemory, naming the part, where the stiffness of its nodes cannot be
  /// factored.
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;
  bool local_is_implicit() const override { return true; }
  double reach() const override { return touching_ ? 1 : 0.5; }
  void expect_touch(bool touching) override { touching_ = touching; }
  void set_responses(const Model& model, bool on, Workspace<double>& work) const override;

 private:
  /// Of each part; none where nothing is implicit.
  using Soft = std::vector<std::unique_ptr<ImplicitPart>>;
  /// Those of the step that is taken.
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
  // Kept between steps: no heap in a step. Factors depend on the model, the step and the state only.
  Soft of_second_, of_first_;   ///< by the order of the step
  State before_;                ///< where a step may have to be taken again
  Workspace<double> filtered_;  ///< parts by what pushes do to their rates
  VecX<double> q_, v_, q_dot_, q_rate1_, v_rate1_, q_rate2_, v_rate2_;
};

}  // namespace pliant
