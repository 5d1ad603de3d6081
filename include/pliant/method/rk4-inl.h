// Bodies of rk4.h.
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/method/rk4.h>

#include <algorithm>
#include <complex>

#include <pliant/body/advance.h>
#include <pliant/project/project.h>

#include <pliant/method/linear_growth.h>

namespace pliant {

namespace rk4 {

inline constexpr double kRk4A[] = {0.5, 0, 0.5, 0, 0, 1}, kRk4Nodes[] = {0, 0.5, 0.5, 1},
                        kRk4Weights[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
inline constexpr ButcherTableau kRk4Tableau{"rk4",     4,       4,       kRk4A, kRk4Weights,
                                            kRk4Nodes, nullptr, nullptr, 0,     false};

/// Adds weight * rate to sum (first: sets it), and computes to = from + step * rate. One function with seven
/// parameters, for one pass over memory.
inline void take(const VecX<double>& rate, double weight, bool first, VecX<double>& sum,
                 const VecX<double>& from, double step, VecX<double>& to) {
  constexpr Eigen::Index in_cache = 512;
  const Eigen::Index n = rate.size();
  sum.resize(n);
  for (Eigen::Index i = 0; i < n; i += in_cache) {
    const Eigen::Index length = std::min(in_cache, n - i);
    const auto now = rate.segment(i, length);
    if (first)
      sum.segment(i, length) = weight * now;
    else
      sum.segment(i, length) += weight * now;
    to.segment(i, length) = from.segment(i, length) + step * now;
  }
}

}  // namespace rk4

PLIANT_INLINE void Rk4::step(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  const double h = state.h, t = state.time();
  Vec<double, kWorks> work_sum = Vec<double, kWorks>::Zero();
  q_ = state.q;
  v_ = state.v;
  free_.prepare(dynamics.model(), rk4::kRk4Tableau, h);
  for (int stage = 0; stage < 4; ++stage) {
    dynamics.rates(t + rk4::kRk4Nodes[stage] * h, q_, v_, state, work,
                   stage == 0 ? RankRule::decide : RankRule::keep);
    ++step.counters.evaluations;
    stop_inertialess(dynamics.model(), work, v_);
    dynamics.coordinate_rates(q_, v_, q_dot_);
    free_.take(stage, q_, v_, work.v_dot);
    free_.still(q_dot_);
    work_sum += rk4::kRk4Weights[stage] * work.power;
    if (stage == 3) break;
    const double length = rk4::kRk4Nodes[stage + 1] * h;
    rk4::take(q_dot_, rk4::kRk4Weights[stage], stage == 0, q_sum_, state.q, length, q_);
    rk4::take(work.v_dot, rk4::kRk4Weights[stage], stage == 0, v_sum_, state.v, length, v_);
    free_.move(stage + 1, state.q, state.v, q_, v_);
  }
  state.q += h * (q_sum_ + rk4::kRk4Weights[3] * q_dot_);
  state.v += h * (v_sum_ + rk4::kRk4Weights[3] * work.v_dot);
  free_.move(4, state.q, state.v, state.q, state.v);
  state.work += h * work_sum;
  step.t = t + h;
  end_motion(step);
  project(step);
}

PLIANT_INLINE double Rk4::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  return linear_growth(K, D, h, [](const std::complex<double>& z) {
    return 1. + z * (1. + z / 2. * (1. + z / 3. * (1. + z / 4.)));
  });
}

}  // namespace pliant
