// Explicit Runge-Kutta methods with an error estimate (Hairer, Norsett & Wanner, Solving Ordinary
// Differential Equations I, chapter II), on (q, v, work). Quaternions are integrated as four numbers by
// theta_dot = 1/2 theta o (0, omega) and normalised after the step; limits, strings and closed joints are
// projected. The normalisation and the projection keep the order. Free oscillators (free_oscillation.h) are
// integrated exactly.
#pragma once

#include <limits>
#include <vector>

#include <pliant/method/butcher_tableau.h>
#include <pliant/method/free_stages.h>
#include <pliant/method/integrator.h>

namespace pliant {

class ExplicitRungeKutta : public Integrator {
 public:
  /// The tableau must outlive the method.
  explicit ExplicitRungeKutta(const ButcherTableau& tableau) : tableau_(&tableau) {}
  const char* name() const override { return tableau_->name; }
  int order() const override { return tableau_->order; }
  int error_order() const override { return tableau_->error_order; }
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;
  /// Returns the dense output of the method, or cubic Hermite interpolation in three cases: the tableau has
  /// no dense output, the model has free oscillators, or an additional stage fails.
  StepPath path(const Dynamics& dynamics, const State& low, double h, const State& high,
                StepCounters& counters) override;

 private:
  /// Evaluates the rates at (t, q_, v_), with the modes of limits, joints and sleep of step.state, and stores
  /// the rates in the columns of a stage.
  void evaluate_stage(StepContext& step, double t, int stage, RankRule rank);
  /// Returns the dense output by the continuous extension of the tableau. Throws StepFailure or
  /// InvertedElement if the model cannot be evaluated at an additional stage.
  StepPath dense_output(const Dynamics& dynamics, const State& low, double h, const State& high,
                        StepCounters& counters);
  /// Returns whether the rates at the end of the last step are valid at this state and time. The last step
  /// must have ended at this state and time, with equal gains of Baumgarte's terms.
  bool end_rates_valid(const Dynamics& dynamics, double t, const State& state) const;
  /// Returns the error of the step, in tolerances. v: the velocities at the start of the step.
  double estimate_error(double h, const VecX<double>& v);

  static constexpr double kNoTime = std::numeric_limits<double>::quiet_NaN();

  const ButcherTableau* tableau_;
  FreeStages free_;
  // Kept between steps, so that a step allocates no memory. The matrices have one column for each stage, one
  // for the end of the step, and one for each additional stage of the dense output.
  MatX<double> q_rates_, v_rates_, powers_;
  VecX<double> q_, v_, q_dot_, v_start_, q_error_, v_error_;
  // State and time of the rates at the end of the last step, if its error estimate has evaluated them
  // (ButcherTableau::rates_at_end). These rates are then the first stage of the next step.
  State last_;
  double last_t_ = kNoTime;           ///< time of these rates, s; kNoTime: there are none
  Workspace<double> extension_work_;  ///< evaluations of the dense output
};

}  // namespace pliant
