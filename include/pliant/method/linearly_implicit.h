// The two-stage Rosenbrock method ROS2 (Verwer, Spee, Blom & Hundsdorfer 1999) on (q, v, work):
//   (I - gamma h A) k1 = F(u),   (I - gamma h A) k2 = F(u + h k1) - 2 k1,   u+ = u + 3/2 h k1 + 1/2 h k2
// with gamma = 1 - 1/sqrt(2). The method is of second order for every A, and L-stable if A is the Jacobian of
// F. A contains q_dot = v for all coordinates. With this term alone undamped oscillations neither grow nor
// decay for h omega < 2.26. For parts that deform locally A also contains the elasticity and damping of their
// nodes or modes and of their global parameters (method/implicit/implicit_part.h). Everything else is
// explicit. The difference from the first-order solution u + h k1 estimates the error.
//
// An impact on a stiff part needs velocities v+ that agree with the displacement in the step,
// q+ - q = h q_dot(v+). A step of ROS2 does not have this property, and a step of linearly implicit Euler has
// it. If a part that deforms locally may touch something, or if a string or a limit stops it, a step of
// linearly implicit Euler therefore replaces the step of ROS2: gamma = 1 and u+ = u + h k1, of first order.
// Impulses on a part change v+ by (I - h A)^-1 M^-1 times the impulse, and q+ by h times this change. The
// work of these impulses is the work of an inelastic impact.
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
  using ImplicitParts = std::vector<std::unique_ptr<ImplicitPart>>;
  /// Returns the implicit parts of the current step.
  ImplicitParts& implicit_parts() { return first_order_ ? first_order_parts_ : second_order_parts_; }
  const ImplicitParts& implicit_parts() const {
    return first_order_ ? first_order_parts_ : second_order_parts_;
  }
  /// Prepares the implicit parts for the calls of filter() in a step, from the evaluation in step.work. The
  /// first call creates the implicit parts. c: gamma h, s.
  void prepare_implicit_parts(StepContext& step, double c);
  /// Filters rates: replaces v_dot by k_v of (I - c A) k = (q_dot, v_dot), and then projects k_v
  /// (implicit/project_rates.h). The projection keeps the values of the rows of joints, of strings that pull
  /// and of limits that push.
  void filter(const Model& model, const Workspace<double>& work, const VecX<double>& q_dot,
              VecX<double>& v_dot);
  /// Advances one step of ROS2, from the evaluation to the projection.
  void advance_second_order(StepContext& step);
  /// Advances one step of linearly implicit Euler.
  void advance_first_order(StepContext& step);
  void end_step(StepContext& step);
  void record_slack_strings(const Model& model, const State& state, const Workspace<double>& work);
  bool needs_first_order(const Model& model, const State& now) const;

  bool touching_ = false;     ///< whether parts that deform locally may touch something
  bool first_order_ = false;  ///< whether the current or last step is a step of linearly implicit Euler
  /// Whether at an evaluation of this step a string did not pull, although its mode is JointMode::closed.
  /// Only strings of islands with an implicit part are checked.
  bool closed_string_was_slack_ = false;
  // Kept between steps, so that a step allocates no memory. The factors are functions of the model, the step
  // length and the state; they do not depend on earlier steps.
  ImplicitParts second_order_parts_, first_order_parts_;  ///< for steps of second and of first order
  State before_;                                          ///< state from which the step can be repeated
  Workspace<double> filtered_;                            ///< scratch storage of project_rates()
  VecX<double> q_, v_, q_dot_, q_rate1_, v_rate1_, q_rate2_, v_rate2_;
};

}  // namespace pliant
