// The motion of joints that hold, to the last digits: Gragg's midpoint rule extrapolated to order 8
// (Bulirsch & Stoer), on accelerations alone: nothing is projected. For references, which it reaches in
// hundreds of evaluations where RK4 takes millions; no method of the engine shares it.
#pragma once

#include <array>

#include <pliant/pliant.h>

namespace pliant::bench {

class Extrapolation {
 public:
  /// From a state on, whose limits and joints stay as they are.
  Extrapolation(const Dynamics& dynamics, const State& start)
      : dynamics_(dynamics), modes_(start), n_q_(start.q.size()), y_(n_q_ + start.v.size()) {
    y_ << start.q, start.v;
    lost_.setZero(y_.size());
  }

  VecX<double> q() const { return y_.head(n_q_); }

  /// Moves from time t to t + step.
  void step(double t, double step) {
    // Changes since the start of the step are kept apart from y, so that its rounding is not theirs.
    const VecX<double> slope = rates(t, y_);
    std::array<VecX<double>, kColumns> T;
    for (int k = 0; k < kColumns; ++k) {
      const int n = 2 * (k + 1);
      const double h = step / n;
      VecX<double> before = VecX<double>::Zero(y_.size()), now = h * slope;
      for (int i = 1; i < n; ++i) {
        before += 2 * h * rates(t + i * h, y_ + now);
        before.swap(now);
      }
      for (int j = 1; j <= k; ++j) {
        const double ratio = static_cast<double>(k + 1) / (k + 1 - j);
        const VecX<double> better = now + (now - T[at(j - 1)]) / (ratio * ratio - 1);
        T[at(j - 1)].swap(now);
        now = better;
      }
      T[at(k)] = now;
    }
    // Kahan's sum.
    const VecX<double> change = T[at(kColumns - 1)] + lost_;
    const VecX<double> sum = y_ + change;
    lost_ = change - (sum - y_);
    y_ = sum;
  }

 private:
  static constexpr int kColumns = 4;
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  VecX<double> rates(double t, const VecX<double>& y) {
    q_ = y.head(n_q_);
    v_ = y.tail(y.size() - n_q_);
    dynamics_.accelerations(t, q_, v_, modes_, work_);
    dynamics_.coordinate_rates(q_, v_, q_dot_);
    VecX<double> rates(y.size());
    rates << q_dot_, work_.v_dot;
    return rates;
  }

  const Dynamics& dynamics_;
  const State modes_;
  Eigen::Index n_q_;
  VecX<double> y_, lost_;
  VecX<double> q_, v_, q_dot_;
  Workspace<double> work_;
};

}  // namespace pliant::bench
