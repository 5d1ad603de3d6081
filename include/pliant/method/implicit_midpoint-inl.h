// Function bodies of implicit_midpoint.h: one implicit stage at the middle of the step.
#pragma once

#include <pliant/method/implicit_midpoint.h>

#include <algorithm>
#include <complex>

#include <pliant/body/advance.h>
#include <pliant/math/header_only.h>
#include <pliant/method/implicit/stage_solver.h>
#include <pliant/method/implicit/stiff_projection_metric.h>
#include <pliant/method/linear_growth.h>
#include <pliant/project/project.h>

namespace pliant {

namespace implicit_midpoint {
/// Tolerance of the iteration, in sizes of the part and radians. The iteration stops at changes of 0.02
/// tolerances (kConverged in implicit/stage_solver-inl.h), which are a small multiple of rounding errors.
inline constexpr double kStageTolerance = 1e-13;
}  // namespace implicit_midpoint

PLIANT_INLINE ImplicitMidpoint::ImplicitMidpoint() = default;
PLIANT_INLINE ImplicitMidpoint::~ImplicitMidpoint() = default;

PLIANT_INLINE void ImplicitMidpoint::step(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  const Model& model = dynamics.model();
  const double h = state.h, t = state.time();
  if (!solver_) {
    solver_ = std::make_unique<StageSolver>(model);
    stage_scale_ = std::make_unique<ErrorScale>(model, implicit_midpoint::kStageTolerance);
  }
  dynamics.accelerations(t, state.q, state.v, state, work);
  ++step.counters.evaluations;
  v_ = state.v;
  zero_inertialess_velocities(model, work, v_);
  dynamics.coordinate_rates(state.q, v_, q_dot_);
  q_ = state.q + 0.5 * h * q_dot_;
  v_ += 0.5 * h * work.v_dot;
  solver_->begin_step(step, 0.5 * h, *stage_scale_);
  solver_->solve(t + 0.5 * h, state.q, state.v, q_, v_);
  state.q = 2 * q_ - state.q;
  state.v = 2 * v_ - state.v;
  state.work += h * work.power;
  step.t = t + h;
  end_motion(step);
  const StiffProjectionMetric pushes(dynamics, step.t, 0.5 * h, state, work);
  project(step);
}

PLIANT_INLINE Eigen::Index ImplicitMidpoint::max_velocities() const {
  return StageSolver::kMaxVelocities;
}

PLIANT_INLINE double ImplicitMidpoint::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  return linear_growth(K, D, h,
                       [](const std::complex<double>& z) { return (1. + 0.5 * z) / (1. - 0.5 * z); });
}

}  // namespace pliant
