// Function bodies of esdirk.h: the coefficients, the stages by StageSolver, the error estimate.
#pragma once

#include <pliant/method/esdirk.h>

#include <algorithm>
#include <complex>

#include <pliant/body/advance.h>
#include <pliant/math/header_only.h>
#include <pliant/method/implicit/stage_solver.h>
#include <pliant/method/implicit/stiff_projection_metric.h>
#include <pliant/method/linear_growth.h>
#include <pliant/project/project.h>

namespace pliant {

namespace esdirk {

inline constexpr int kStages = 6;
inline constexpr double kGamma = 0.25;
/// Entries below the diagonal, row by row. The diagonal entries are 0 in the first row and kGamma in all
/// other rows. The last row has the weights of the method; the last weight is kGamma.
inline constexpr double kA[kStages][kStages] = {
    {},
    {1. / 4},
    {8611. / 62500, -1743. / 31250},
    {5012029. / 34652500, -654441. / 2922500, 174375. / 388108},
    {15267082809. / 155376265600, -71443401. / 120774400, 730878875. / 902184768, 2285395. / 8070912},
    {82889. / 524892, 0, 15625. / 83664, 69875. / 102672, -2260. / 8211}};
inline constexpr double kC[kStages] = {0, 1. / 2, 83. / 250, 31. / 50, 17. / 20, 1};
/// Weights of the embedded method of order 3.
inline constexpr double kB3[kStages] = {4586570599. / 29645900160, 0,
                                        178811875. / 945068544,    814220225. / 1159782912,
                                        -3700637. / 11593932,      61727. / 225920};
/// Tolerance of the iteration of a stage if the simulation has no tolerance, in sizes of the part and
/// radians.
inline constexpr double kStageTolerance = 1e-11;

/// Returns the weight of a stage in the result of order 4; the stages are counted from 0.
inline double weight(int stage) {
  return stage == kStages - 1 ? kGamma : kA[kStages - 1][stage];
}

}  // namespace esdirk

PLIANT_INLINE Esdirk::Esdirk() = default;
PLIANT_INLINE Esdirk::~Esdirk() = default;

PLIANT_INLINE void Esdirk::step(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  const Model& model = dynamics.model();
  const double h = state.h, t = state.time(), c = esdirk::kGamma * h;
  if (!solver_) {
    solver_ = std::make_unique<StageSolver>(model);
    stage_scale_ = std::make_unique<ErrorScale>(model, esdirk::kStageTolerance);
    q_rates_.resize(model.n_q(), esdirk::kStages);
    v_rates_.resize(model.n_v(), esdirk::kStages);
  }
  dynamics.accelerations(t, state.q, state.v, state, work);
  ++step.counters.evaluations;
  v_ = state.v;
  zero_inertialess_velocities(model, work, v_);
  dynamics.coordinate_rates(state.q, v_, q_dot_);
  q_rates_.col(0) = q_dot_;
  v_rates_.col(0) = work.v_dot;
  Vec<double, kWorks> power = esdirk::weight(0) * work.power;
  solver_->begin_step(step, c, scale() != nullptr ? *scale() : *stage_scale_);
  for (int stage = 1; stage < esdirk::kStages; ++stage) {
    r_q_ = state.q;
    r_v_ = state.v;
    for (int k = 0; k < stage; ++k) {
      r_q_ += h * esdirk::kA[stage][k] * q_rates_.col(k);
      r_v_ += h * esdirk::kA[stage][k] * v_rates_.col(k);
    }
    q_ = r_q_ + c * q_rates_.col(stage - 1);
    v_ = r_v_ + c * v_rates_.col(stage - 1);
    solver_->solve(t + esdirk::kC[stage] * h, r_q_, r_v_, q_, v_);
    q_rates_.col(stage) = (q_ - r_q_) / c;
    v_rates_.col(stage) = (v_ - r_v_) / c;
    power += esdirk::weight(stage) * work.power;
  }
  if (scale() != nullptr) {
    r_q_.setZero();
    r_v_.setZero();
    for (int k = 0; k < esdirk::kStages; ++k) {
      r_q_ += h * (esdirk::weight(k) - esdirk::kB3[k]) * q_rates_.col(k);
      r_v_ += h * (esdirk::weight(k) - esdirk::kB3[k]) * v_rates_.col(k);
    }
    solver_->damp(r_q_, r_v_);
    record_error(scale()->norm(r_q_, r_v_, state.v));
  }
  state.q = q_;  // stiffly accurate: the last stage is the end of the step
  state.v = v_;
  state.work += h * power;
  step.t = t + h;
  end_motion(step);
  const StiffProjectionMetric pushes(dynamics, step.t, c, state, work);
  project(step);
}

PLIANT_INLINE Eigen::Index Esdirk::max_velocities() const {
  return StageSolver::kMaxVelocities;
}

PLIANT_INLINE double Esdirk::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  return linear_growth(K, D, h, [](const std::complex<double>& z) {
    std::complex<double> rate[esdirk::kStages] = {z}, y = 1;
    for (int stage = 1; stage < esdirk::kStages; ++stage) {
      y = 1;
      for (int k = 0; k < stage; ++k) y += esdirk::kA[stage][k] * rate[k];
      y /= 1. - esdirk::kGamma * z;
      rate[stage] = z * y;
    }
    return y;
  });
}

}  // namespace pliant
