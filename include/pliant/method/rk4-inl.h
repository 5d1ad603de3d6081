// Function bodies of rk4.h: the four stages of the classical Runge-Kutta method.
#pragma once

#include <pliant/method/rk4.h>

#include <algorithm>
#include <complex>

#include <pliant/body/advance.h>
#include <pliant/math/header_only.h>
#include <pliant/method/linear_growth.h>
#include <pliant/project/project.h>

namespace pliant {

namespace rk4 {

inline constexpr double kA[] = {0.5, 0, 0.5, 0, 0, 1}, kC[] = {0, 0.5, 0.5, 1},
                        kB[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
inline constexpr ButcherTableau kTableau{"rk4", 4, 4, kA, kB, kC, nullptr, nullptr, 0, false};

/// Adds weight * rate to sum, or sets sum to weight * rate if `first` is true. Computes to = from + step *
/// rate. Both results come from one pass over memory.
inline void accumulate(const VecX<double>& rate, double weight, bool first, VecX<double>& sum,
                       const VecX<double>& from, double step, VecX<double>& to) {
  constexpr Eigen::Index kBlock = 512;  // rows of a block that stays in the cache
  const Eigen::Index n = rate.size();
  sum.resize(n);
  for (Eigen::Index i = 0; i < n; i += kBlock) {
    const Eigen::Index length = std::min(kBlock, n - i);
    const auto block = rate.segment(i, length);
    if (first)
      sum.segment(i, length) = weight * block;
    else
      sum.segment(i, length) += weight * block;
    to.segment(i, length) = from.segment(i, length) + step * block;
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
  free_.prepare(dynamics.model(), rk4::kTableau, h);
  for (int stage = 0; stage < 4; ++stage) {
    dynamics.rates(t + rk4::kC[stage] * h, q_, v_, state, work,
                   stage == 0 ? RankRule::decide : RankRule::keep);
    ++step.counters.evaluations;
    zero_inertialess_velocities(dynamics.model(), work, v_);
    dynamics.coordinate_rates(q_, v_, q_dot_);
    free_.store_loads(stage, q_, v_, work.v_dot);
    free_.clear_rates(q_dot_);
    work_sum += rk4::kB[stage] * work.power;
    if (stage == 3) break;
    const double length = rk4::kC[stage + 1] * h;
    rk4::accumulate(q_dot_, rk4::kB[stage], stage == 0, q_sum_, state.q, length, q_);
    rk4::accumulate(work.v_dot, rk4::kB[stage], stage == 0, v_sum_, state.v, length, v_);
    free_.advance(stage + 1, state.q, state.v, q_, v_);
  }
  state.q += h * (q_sum_ + rk4::kB[3] * q_dot_);
  state.v += h * (v_sum_ + rk4::kB[3] * work.v_dot);
  free_.advance(4, state.q, state.v, state.q, state.v);
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
