// Function bodies of explicit_runge_kutta.h: the step, its error estimate and its dense output for any
// Butcher tableau.
#pragma once

#include <pliant/method/explicit_runge_kutta.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

#include <pliant/body/advance.h>
#include <pliant/body/step_failure.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/method/linear_growth.h>
#include <pliant/project/project.h>

namespace pliant {

namespace explicit_runge_kutta {

/// Computes to = from + h sum weights_i column_i in one pass over memory, four columns at a time.
inline void combine(const VecX<double>& from, const MatX<double>& columns, const double* weights, int count,
                    double h, VecX<double>& to) {
  constexpr Eigen::Index kBlock = 256;  // rows of a block that stays in the cache
  constexpr int kMaxStages = 16, kAtOnce = 4;
  std::array<double, kMaxStages> weight;
  std::array<const double*, kMaxStages> column;
  int used = 0;
  for (int k = 0; k < count; ++k) {
    if (weights[k] == 0) continue;
    weight[at(used)] = h * weights[k];
    column[at(used++)] = columns.col(k).data();
  }
  const Eigen::Index n = from.size();
  to.resize(n);
  for (Eigen::Index i = 0; i < n; i += kBlock) {
    const Eigen::Index end = std::min(i + kBlock, n);
    double* __restrict sum = to.data();
    std::copy(from.data() + i, from.data() + end, sum + i);
    int k = 0;
    for (; k + kAtOnce <= used; k += kAtOnce) {
      const double w0 = weight[at(k)], w1 = weight[at(k + 1)], w2 = weight[at(k + 2)], w3 = weight[at(k + 3)];
      const double *x0 = column[at(k)], *x1 = column[at(k + 1)], *x2 = column[at(k + 2)],
                   *x3 = column[at(k + 3)];
      for (Eigen::Index j = i; j < end; ++j)
        sum[j] = sum[j] + w0 * x0[j] + w1 * x1[j] + w2 * x2[j] + w3 * x3[j];
    }
    for (; k < used; ++k) {
      const double w = weight[at(k)];
      const double* x = column[at(k)];
      for (Eigen::Index j = i; j < end; ++j) sum[j] += w * x[j];
    }
  }
}

/// Computes to = h sum weights_i column_i.
inline void sum(const MatX<double>& columns, const double* weights, int count, double h, VecX<double>& to) {
  to.setZero(columns.rows());
  for (int k = 0; k < count; ++k)
    if (weights[k] != 0) to += (h * weights[k]) * columns.col(k);
}

}  // namespace explicit_runge_kutta

PLIANT_INLINE void ExplicitRungeKutta::evaluate_stage(StepContext& step, double t, int stage, RankRule rank) {
  Workspace<double>& work = step.work;
  step.dynamics.rates(t, q_, v_, step.state, step.work, rank);
  ++step.counters.evaluations;
  zero_inertialess_velocities(step.model(), work, v_);
  step.dynamics.coordinate_rates(q_, v_, q_dot_);
  free_.store_loads(stage, q_, v_, work.v_dot);
  q_rates_.col(stage) = q_dot_;
  v_rates_.col(stage) = work.v_dot;
  powers_.col(stage) = work.power;
}

/// The gains of Baumgarte's terms are compared because they may depend on the length of the step.
PLIANT_INLINE bool ExplicitRungeKutta::end_rates_valid(const Dynamics& dynamics, double t,
                                                       const State& state) const {
  auto gains = [&](double step) {
    return dynamics.model().body().stabilization.gains(step, dynamics.joint_policy().step_consistent);
  };
  return last_t_ == t && gains(last_.h) == gains(state.h) && last_.q == state.q && last_.v == state.v &&
         last_.at_limit == state.at_limit && last_.joints == state.joints &&
         same_sleepers(last_.at_rest, state.at_rest);
}

PLIANT_INLINE void ExplicitRungeKutta::step(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  const ButcherTableau& tableau = *tableau_;
  const double h = state.h, t = state.time();
  const int n = tableau.stages;
  if (powers_.cols() == 0 || q_rates_.rows() != state.q.size()) {
    last_t_ = kNoTime;
    const int additional = tableau.extension == nullptr ? 0 : tableau.extension->stages;
    q_rates_.resize(state.q.size(), n + 1 + additional);
    v_rates_.resize(state.v.size(), n + 1 + additional);
    powers_.setZero(kWorks, n + 1 + additional);
  }
  free_.prepare(dynamics.model(), tableau, h);
  if (end_rates_valid(dynamics, t, state)) {
    q_rates_.col(0) = q_rates_.col(n);
    v_rates_.col(0) = v_rates_.col(n);
    powers_.col(0) = powers_.col(n);
    free_.reuse_end_rates();
  } else {
    q_ = state.q;
    v_ = state.v;
    evaluate_stage(step, t, 0, RankRule::decide);
  }
  const double* a = tableau.a;
  for (int stage = 1; stage < n; a += stage, ++stage) {
    explicit_runge_kutta::combine(state.q, q_rates_, a, stage, h, q_);
    explicit_runge_kutta::combine(state.v, v_rates_, a, stage, h, v_);
    free_.advance(stage, state.q, state.v, q_, v_);
    evaluate_stage(step, t + tableau.c[stage] * h, stage, RankRule::keep);
  }
  for (int k = 0; k < n; ++k)
    if (tableau.b[k] != 0) state.work += (h * tableau.b[k]) * powers_.col(k);
  explicit_runge_kutta::combine(state.q, q_rates_, tableau.b, n, h, q_);
  explicit_runge_kutta::combine(state.v, v_rates_, tableau.b, n, h, v_);
  free_.advance(n, state.q, state.v, q_, v_);
  if (scale() != nullptr) v_start_ = state.v;
  state.q.swap(q_);
  state.v.swap(v_);
  step.t = t + h;
  end_motion(step);
  project(step);
  if (scale() == nullptr || !state.q.allFinite() || !state.v.allFinite()) return;
  if (tableau.rates_at_end) {
    q_ = state.q;
    v_ = state.v;
    evaluate_stage(step, t + h, n, RankRule::decide);
    last_ = state;
    last_t_ = t + h;
  }
  record_error(estimate_error(h, v_start_));
}

PLIANT_INLINE StepPath ExplicitRungeKutta::path(const Dynamics& dynamics, const State& low, double h,
                                                const State& high, StepCounters& counters) {
  if (tableau_->extension == nullptr || free_.has_oscillators())
    return Integrator::path(dynamics, low, h, high, counters);
  try {
    return dense_output(dynamics, low, h, high, counters);
  } catch (const StepFailure&) {  // the model cannot be evaluated at an additional stage
  } catch (const InvertedElement&) {
  }
  return Integrator::path(dynamics, low, h, high, counters);
}

PLIANT_INLINE StepPath ExplicitRungeKutta::dense_output(const Dynamics& dynamics, const State& low, double h,
                                                        const State& high, StepCounters& counters) {
  const ContinuousExtension& extension = *tableau_->extension;
  const double t = low.time();
  State modes = high;  // the stages read only its modes of limits, joints and sleep
  StepContext context(dynamics, modes, extension_work_, counters);
  const int n = tableau_->stages, all = n + 1 + extension.stages;
  if (!end_rates_valid(dynamics, t + h, high)) {
    last_t_ = kNoTime;
    q_ = high.q;
    v_ = high.v;
    evaluate_stage(context, t + h, n, RankRule::decide);
  }
  const double* a = extension.a;
  for (int k = n + 1; k < all; a += k, ++k) {
    explicit_runge_kutta::combine(low.q, q_rates_, a, k, h, q_);
    explicit_runge_kutta::combine(low.v, v_rates_, a, k, h, v_);
    evaluate_stage(context, t + extension.c[k - n - 1] * h, k, RankRule::decide);
  }
  StepPolynomial q{low.q, hermite_terms(low.q, q_rates_.col(0), h, high.q, q_rates_.col(n), extension.terms)};
  q.terms.rightCols(extension.terms).noalias() =
      h * q_rates_ * Eigen::Map<const MatX<double>>(extension.d, all, extension.terms);
  return {dynamics.model(), std::move(q)};
}

/// The weights `error` and `second_error` of the tableau give two estimates e_1 and e_2. The error is e_1^2 /
/// sqrt(e_1^2 + 0.01 e_2^2), as in DOP853 (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations
/// I, section II.10). Without `second_error` the error is e_1.
PLIANT_INLINE double ExplicitRungeKutta::estimate_error(double h, const VecX<double>& v) {
  const int count = tableau_->stages + (tableau_->rates_at_end ? 1 : 0);
  auto weighted_norm = [&](const double* weights) {
    explicit_runge_kutta::sum(q_rates_, weights, count, h, q_error_);
    explicit_runge_kutta::sum(v_rates_, weights, count, h, v_error_);
    free_.estimate_error(weights, count, q_error_, v_error_);
    return scale()->norm(q_error_, v_error_, v);
  };
  const double first = weighted_norm(tableau_->error);
  if (tableau_->second_error == nullptr || first == 0) return first;
  const double second = weighted_norm(tableau_->second_error);
  return first * first / std::sqrt(first * first + 0.01 * second * second);
}

PLIANT_INLINE double ExplicitRungeKutta::growth(const MatX<double>& K, const MatX<double>& D,
                                                double h) const {
  std::vector<std::complex<double>> rate(static_cast<std::size_t>(tableau_->stages));
  return linear_growth(K, D, h, [&](const std::complex<double>& z) {
    const double* a = tableau_->a;
    std::complex<double> end = 1;
    for (int stage = 0; stage < tableau_->stages; a += stage, ++stage) {
      std::complex<double> y = 1;
      for (int j = 0; j < stage; ++j) y += a[j] * rate[static_cast<std::size_t>(j)];
      rate[static_cast<std::size_t>(stage)] = z * y;
      end += tableau_->b[stage] * rate[static_cast<std::size_t>(stage)];
    }
    return end;
  });
}

}  // namespace pliant
