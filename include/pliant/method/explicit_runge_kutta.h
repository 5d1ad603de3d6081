// Explicit Runge-Kutta methods with an estimate of the error of a step (Hairer, Norsett & Wanner, Solving
// Ordinary Differential Equations I, chapter II), on (q, v, work). Quaternions are integrated as four numbers
// by theta_dot = 1/2 theta o (0, omega) and brought back to unit length after the step, closed joints are
// projected: neither costs an order. What oscillates freely does so exactly.
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
  /// By its continuous extension; where something oscillates freely as other methods do.
  StepPath path(const Dynamics& dynamics, const State& low, double h, const State& high,
                StepCounters& counters) override;

 private:
  /// Evaluates the rates at (t, q_, v_), with the discrete modes of step.state, into the columns of a stage.
  void evaluate_stage(StepContext& step, double t, int stage, RankRule rank);
  StepPath extended(const Dynamics& dynamics, const State& low, double h, const State& high,
                    StepCounters& counters);
  bool ended_at(const Dynamics& dynamics, double t, const State& state) const;
  /// Of the step that was taken, in tolerances; v: velocities at its start.
  double error_of(double h, const VecX<double>& v);

  const ButcherTableau* of_;
  FreeStages free_;
  // Kept between steps: no heap in a step.
  MatX<double> q_rates_, v_rates_, powers_;  ///< a column a stage, and one of the rates at the end
  VecX<double> q_, v_, q_dot_, v_start_, q_error_, v_error_;
  // Where the rates at the end were taken, which are those at the start of the next step.
  State last_;
  double last_t_ = 0;
  Workspace<double> between_work_;  ///< of rates that are taken after a step
};

}  // namespace pliant
