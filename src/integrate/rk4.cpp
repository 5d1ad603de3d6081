#include <pliant/integrate/rk4.h>

#include <complex>

#include <Eigen/Eigenvalues>

#include <pliant/integrate/advance.h>
#include <pliant/integrate/settle.h>

namespace pliant {

void Rk4::step(const Dynamics& dynamics, State& state, Workspace<double>& work, StepCounters& counters) {
  const double h = state.h, t = state.time();
  Vec<double, kWorks> work_sum = Vec<double, kWorks>::Zero();
  q_sum_.setZero(state.q.size());
  v_sum_.setZero(state.v.size());
  q_ = state.q;
  v_ = state.v;
  free_.prepare(dynamics.model(), 0.5 * h);
  constexpr double node[4] = {0, 0.5, 0.5, 1}, weight[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
  for (int stage = 0; stage < 4; ++stage) {
    dynamics.accelerations(t + node[stage] * h, q_, v_, state, work,
                           stage == 0 ? RankRule::decide : RankRule::keep);
    ++counters.evaluations;
    hold_inertialess(dynamics.model(), work, v_);
    dynamics.coordinate_rates(q_, v_, q_dot_);
    free_.take_off(q_, v_, work.v_dot);
    free_.take_off(q_dot_);
    q_sum_ += weight[stage] * q_dot_;
    v_sum_ += weight[stage] * work.v_dot;
    work_sum += weight[stage] * work.power;
    if (stage == 3) break;
    if (!free_.empty() && stage != 1) {  // on to the next node
      free_.move(state.q, state.v);
      free_.move(q_sum_, v_sum_);
      free_.move(q_dot_, work.v_dot);
    }
    q_ = state.q + node[stage + 1] * h * q_dot_;
    v_ = state.v + node[stage + 1] * h * work.v_dot;
  }
  state.q += h * q_sum_;
  state.v += h * v_sum_;
  state.work += h * work_sum;
  hold_inertialess(dynamics.model(), work, state.v);
  normalise_rotations(dynamics.model(), state.q);
  settle_frames(dynamics, t + h, state, work);
  settle_limits(dynamics, t + h, state, work, counters);
  settle_joints(dynamics, t + h, state, work, counters);
}

double Rk4::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  const Eigen::Index n = K.rows();
  MatX<double> A(2 * n, 2 * n);
  A << MatX<double>::Zero(n, n), MatX<double>::Identity(n, n), -K, -D;
  double worst = 0;
  for (const std::complex<double>& lambda : A.eigenvalues()) {
    const std::complex<double> z = h * lambda;
    worst = std::max(worst, std::abs(1. + z * (1. + z / 2. * (1. + z / 3. * (1. + z / 4.)))));
  }
  return worst;
}

}  // namespace pliant
