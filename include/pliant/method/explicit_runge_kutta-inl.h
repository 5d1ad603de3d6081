// Bodies of explicit_runge_kutta.h.
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/method/explicit_runge_kutta.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <utility>

#include <pliant/body/advance.h>
#include <pliant/body/step_failure.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/math/index.h>
#include <pliant/project/project.h>

#include <pliant/method/linear_growth.h>

namespace pliant {

namespace explicit_runge_kutta {

/// Computes to = from + h sum weights_i column_i in one pass over memory, four columns at a time.
inline void combine(const VecX<double>& from, const MatX<double>& columns, const double* weights, int count,
                    double h, VecX<double>& to) {
  constexpr Eigen::Index in_cache = 256;
  constexpr int kMostStages = 16, kAtOnce = 4;
  std::array<double, kMostStages> weight;
  std::array<const double*, kMostStages> column;
  int used = 0;
  for (int k = 0; k < count; ++k) {
    if (weights[k] == 0) continue;
    weight[at(used)] = h * weights[k];
    column[at(used++)] = columns.col(k).data();
  }
  const Eigen::Index n = from.size();
  to.resize(n);
  for (Eigen::Index i = 0; i < n; i += in_cache) {
    const Eigen::Index end = std::min(i + in_cache, n);
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
  stop_inertialess(step.model(), work, v_);
  step.dynamics.coordinate_rates(q_, v_, q_dot_);
  free_.take(stage, q_, v_, work.v_dot);
  q_rates_.col(stage) = q_dot_;
  v_rates_.col(stage) = work.v_dot;
  powers_.col(stage) = work.power;
}

/// Returns whether the rates at the end of the last step are valid at this state and time. Baumgarte's gains,
/// and with them the rates, may depend on the length of the step.
PLIANT_INLINE bool ExplicitRungeKutta::ended_at(const Dynamics& dynamics, double t,
                                                const State& state) const {
  auto gains = [&](double step) {
    return dynamics.model().body().stabilization.gains(step, dynamics.joint_policy().step_consistent);
  };
  return last_t_ == t && last_.q.size() == state.q.size() && gains(last_.h) == gains(state.h) &&
         last_.q == state.q && last_.v == state.v && last_.at_limit == state.at_limit &&
         last_.joints == state.joints && same_sleepers(last_.at_rest, state.at_rest);
}

PLIANT_INLINE void ExplicitRungeKutta::step(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  const ButcherTableau& of = *of_;
  const double h = state.h, t = state.time();
  const int n = of.stages;
  if (q_rates_.rows() != state.q.size()) {
    last_.q.resize(0);
    const int more = of.between == nullptr ? 0 : of.between->stages;
    q_rates_.resize(state.q.size(), n + 1 + more);
    v_rates_.resize(state.v.size(), n + 1 + more);
    powers_.resize(kWorks, n + 1 + more);
  }
  free_.prepare(dynamics.model(), of, h);
  if (ended_at(dynamics, t, state)) {
    q_rates_.col(0) = q_rates_.col(n);
    v_rates_.col(0) = v_rates_.col(n);
    powers_.col(0) = powers_.col(n);
    free_.reuse_end_rates();
  } else {
    q_ = state.q;
    v_ = state.v;
    evaluate_stage(step, t, 0, RankRule::decide);
  }
  const double* a = of.a;
  for (int stage = 1; stage < n; a += stage, ++stage) {
    explicit_runge_kutta::combine(state.q, q_rates_, a, stage, h, q_);
    explicit_runge_kutta::combine(state.v, v_rates_, a, stage, h, v_);
    free_.move(stage, state.q, state.v, q_, v_);
    evaluate_stage(step, t + of.c[stage] * h, stage, RankRule::keep);
  }
  for (int k = 0; k < n; ++k)
    if (of.b[k] != 0) state.work += (h * of.b[k]) * powers_.col(k);
  explicit_runge_kutta::combine(state.q, q_rates_, of.b, n, h, q_);
  explicit_runge_kutta::combine(state.v, v_rates_, of.b, n, h, v_);
  free_.move(n, state.q, state.v, q_, v_);
  if (scale() != nullptr) v_start_ = state.v;
  state.q.swap(q_);
  state.v.swap(v_);
  step.t = t + h;
  end_motion(step);
  project(step);
  if (scale() == nullptr || !state.q.allFinite() || !state.v.allFinite()) return;
  if (of.rates_at_end) {
    q_ = state.q;
    v_ = state.v;
    evaluate_stage(step, t + h, n, RankRule::decide);
    last_ = state;
    last_t_ = t + h;
  }
  note_error(error_of(h, v_start_));
}

PLIANT_INLINE StepPath ExplicitRungeKutta::path(const Dynamics& dynamics, const State& low, double h,
                                                const State& high, StepCounters& counters) {
  if (of_->between == nullptr || free_.any()) return Integrator::path(dynamics, low, h, high, counters);
  try {
    return extended(dynamics, low, h, high, counters);
  } catch (const StepFailure&) {  // the interpolated coordinates left the range of the model
  } catch (const InvertedElement&) {
  }
  return Integrator::path(dynamics, low, h, high, counters);
}

PLIANT_INLINE StepPath ExplicitRungeKutta::extended(const Dynamics& dynamics, const State& low, double h,
                                                    const State& high, StepCounters& counters) {
  const ContinuousExtension& between = *of_->between;
  const double t = low.time();
  State modes = high;  // the stages read the discrete modes alone
  StepContext after(dynamics, modes, between_work_, counters);
  const int n = of_->stages, all = n + 1 + between.stages;
  if (!ended_at(dynamics, t + h, high)) {
    last_.q.resize(0);
    q_ = high.q;
    v_ = high.v;
    evaluate_stage(after, t + h, n, RankRule::decide);
  }
  const double* a = between.a;
  for (int k = n + 1; k < all; a += k, ++k) {
    explicit_runge_kutta::combine(low.q, q_rates_, a, k, h, q_);
    explicit_runge_kutta::combine(low.v, v_rates_, a, k, h, v_);
    evaluate_stage(after, t + between.c[k - n - 1] * h, k, RankRule::decide);
  }
  StepPolynomial q{low.q, hermite_terms(low.q, q_rates_.col(0), h, high.q, q_rates_.col(n), between.terms)};
  q.terms.rightCols(between.terms).noalias() =
      h * q_rates_ * Eigen::Map<const MatX<double>>(between.d, all, between.terms);
  return {dynamics.model(), std::move(q)};
}

PLIANT_INLINE double ExplicitRungeKutta::error_of(double h, const VecX<double>& v) {
  const int count = of_->stages + (of_->rates_at_end ? 1 : 0);
  auto size = [&](const double* weights) {
    explicit_runge_kutta::sum(q_rates_, weights, count, h, q_error_);
    explicit_runge_kutta::sum(v_rates_, weights, count, h, v_error_);
    free_.weigh(weights, count, q_error_, v_error_);
    return scale()->norm(q_error_, v_error_, v);
  };
  const double first = size(of_->error);
  if (of_->second_error == nullptr || first == 0) return first;
  const double second = size(of_->second_error);
  return first * first / std::sqrt(first * first + 0.01 * second * second);
}

PLIANT_INLINE double ExplicitRungeKutta::growth(const MatX<double>& K, const MatX<double>& D,
                                                double h) const {
  std::vector<std::complex<double>> rate(static_cast<std::size_t>(of_->stages));
  return linear_growth(K, D, h, [&](const std::complex<double>& z) {
    const double* a = of_->a;
    std::complex<double> end = 1;
    for (int stage = 0; stage < of_->stages; a += stage, ++stage) {
      std::complex<double> y = 1;
      for (int j = 0; j < stage; ++j) y += a[j] * rate[static_cast<std::size_t>(j)];
      rate[static_cast<std::size_t>(stage)] = z * y;
      end += of_->b[stage] * rate[static_cast<std::size_t>(stage)];
    }
    return end;
  });
}

}  // namespace pliant
