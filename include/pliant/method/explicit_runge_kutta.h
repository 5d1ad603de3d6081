// Explicit Runge-Kutta methods with an error estimate (Hairer, Norsett & Wanner, Solving Ordinary
// Differential Equations I, chapter II), on (q, v, work). Quaternions are integrated as four numbers by
// theta_dot = 1/2 theta o (0, omega) and normalised after the step; closed joints are projected. Both keep
// the order. Free oscillators are integrated exactly.
#pragma once

#include <vector>

#include <pliant/method/butcher_tableau.h>
#include <pliant/method/free_stages.h>
#include <pliant/method/integrator.h>

namespace pliant {

class ExplicitRungeKutta : public Integrator {
 public:
  explicit ExplicitRungeKutta(const ButcherTableau& tableau) : of_(&tableau) {}
  const char* name() const override { return of_->name; }
  int order() const override { return of_->order; }
  int error_order() const override { return of_->error_order; }
  void step(StepContext& step) override;
  double growth(const MatX<double>& K, const MatX<double>& D, double h) const override;
  /// Returns the dense output of the method. With free oscillators it is cubic Hermite interpolation.
  StepPath path(const Dynamics& dynamics, const State& low, double h, const State& high,
                StepCounters& counters) override;

 private:
  /// Evaluates the rates at (t, q_, v_), with the discrete modes of step.state, into the columns of a stage.
  void evaluate_stage(StepContext& step, double t, int stage, RankRule rank);
  StepPath extended(const Dynamics& dynamics, const State& low, double h, const State& high,
                    StepCounters& counters);
  bool ended_at(const Dynamics& dynamics, double t, const State& state) const;
  /// Returns the error of the step, in tolerances. v: the velocities at its start.
  double error_of(double h, const VecX<double>& v);

  const ButcherTableau* of_;
  FreeStages free_;
  // Kept between steps, so that a step allocates no memory.
  MatX<double> q_rates_, v_rates_,
      powers_;  ///< one column for each stage, and one for the rates at the end of the step
  VecX<double> q_, v_, q_dot_, v_start_, q_error_, v_error_;
  // The state at which the rates at the end were evaluated: they are the first stage of the next step.
  State last_;
  double last_t_ = 0;
  Workspace<double> between_work_;  ///< of the additional stages of the dense output
};

}  // namespace pliant
