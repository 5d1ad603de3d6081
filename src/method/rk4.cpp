#include <pliant/method/rk4.h>

#include <algorithm>
#include <complex>

#include <pliant/body/advance.h>
#include <pliant/project/project.h>

#include "linear_growth.h"

namespace pliant {

namespace {

constexpr double kRk4A[] = {0.5, 0, 0.5, 0, 0, 1}, kRk4Nodes[] = {0, 0.5, 0.5, 1},
                 kRk4Weights[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
constexpr ButcherTableau kRk4Tableau{"rk4", 4, 4, kRk4A, kRk4Weights, kRk4Nodes, nullptr, nullptr, 0, false};

/// sum += weight rate, or its first share, and to = from + step rate: in one pass over memory.
void take(const VecX<double>& rate, double weight, bool first, VecX<double>& sum, const VecX<double>& from,
          double step, VecX<double>& to) {
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

}  // namespace

void Rk4::step(const Dynamics& dynamics, State& state, Workspace<double>& work, StepCounters& counters) {
  const double h = state.h, t = state.time();
  Vec<double, kWorks> work_sum = Vec<double, kWorks>::Zero();
  q_ = state.q;
  v_ = state.v;
  free_.prepare(dynamics.model(), kRk4Tableau, h);
  for (int stage = 0; stage < 4; ++stage) {
    dynamics.rates(t + kRk4Nodes[stage] * h, q_, v_, state, work,
                   stage == 0 ? RankRule::decide : RankRule::keep);
    ++counters.evaluations;
    stop_inertialess(dynamics.model(), work, v_);
    dynamics.coordinate_rates(q_, v_, q_dot_);
    free_.take(stage, q_, v_, work.v_dot);
    free_.still(q_dot_);
    work_sum += kRk4Weights[stage] * work.power;
    if (stage == 3) break;
    const double step = kRk4Nodes[stage + 1] * h;
    take(q_dot_, kRk4Weights[stage], stage == 0, q_sum_, state.q, step, q_);
    take(work.v_dot, kRk4Weights[stage], stage == 0, v_sum_, state.v, step, v_);
    free_.move(stage + 1, state.q, state.v, q_, v_);
  }
  state.q += h * (q_sum_ + kRk4Weights[3] * q_dot_);
  state.v += h * (v_sum_ + kRk4Weights[3] * work.v_dot);
  free_.move(4, state.q, state.v, state.q, state.v);
  state.work += h * work_sum;
  end_motion(dynamics, t + h, state, work);
  project(dynamics, t + h, state, work, counters);
}

double Rk4::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  return linear_growth(K, D, h, [](const std::complex<double>& z) {
    return 1. + z * (1. + z / 2. * (1. + z / 3. * (1. + z / 4.)));
  });
}

}  // namespace pliant
