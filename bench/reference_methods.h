// References for smooth motion, to rounding, by two methods of order 8 that the engine does not use. They
// need hundreds of evaluations where RK4 needs millions. Both use accelerations alone, without projection.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <pliant/pliant.h>

namespace pliant::bench {

/// The motion y = (q, v) from a state, with constant modes of limits and joints.
class SmoothMotion {
 public:
  SmoothMotion(const Dynamics& dynamics, const State& start)
      : dynamics_(dynamics), modes_(start), n_q_(start.q.size()), y_(n_q_ + start.v.size()) {
    y_ << start.q, start.v;
    lost_.setZero(y_.size());
  }
  virtual ~SmoothMotion() = default;
  VecX<double> q() const { return y_.head(n_q_); }
  VecX<double> v() const { return y_.tail(y_.size() - n_q_); }
  /// Moves from time t to t + h.
  void step(double t, double h) {
    // Changes within a step are kept apart from y, so that its rounding is not theirs; Kahan's sum.
    const VecX<double> to_add = change(t, h) + lost_;
    const VecX<double> sum = y_ + to_add;
    lost_ = to_add - (sum - y_);
    y_ = sum;
  }

 protected:
  virtual VecX<double> change(double t, double h) = 0;
  const VecX<double>& y() const { return y_; }
  VecX<double> rates(double t, const VecX<double>& y) {
    q_ = y.head(n_q_);
    v_ = y.tail(y.size() - n_q_);
    dynamics_.accelerations(t, q_, v_, modes_, work_);
    dynamics_.coordinate_rates(q_, v_, q_dot_);
    VecX<double> rates(y.size());
    rates << q_dot_, work_.v_dot;
    return rates;
  }

 private:
  const Dynamics& dynamics_;
  const State modes_;
  Eigen::Index n_q_;
  VecX<double> y_, lost_;
  VecX<double> q_, v_, q_dot_;
  Workspace<double> work_;
};

/// Gragg's midpoint rule, extrapolated (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
/// section II.9).
class Extrapolation final : public SmoothMotion {
 public:
  using SmoothMotion::SmoothMotion;

 private:
  static constexpr int kColumns = 4;

  VecX<double> change(double t, double step) override {
    const VecX<double> slope = rates(t, y());
    std::array<VecX<double>, kColumns> T;
    for (int k = 0; k < kColumns; ++k) {
      const int n = 2 * (k + 1);
      const double h = step / n;
      VecX<double> before = VecX<double>::Zero(slope.size()), now = h * slope;
      for (int i = 1; i < n; ++i) {
        before += 2 * h * rates(t + i * h, y() + now);
        before.swap(now);
      }
      for (int j = 1; j <= k; ++j) {
        const double ratio = static_cast<double>(k + 1) / (k + 1 - j);
        VecX<double>& coarser = T[static_cast<std::size_t>(j - 1)];
        const VecX<double> better = now + (now - coarser) / (ratio * ratio - 1);
        coarser.swap(now);
        now = better;
      }
      T[static_cast<std::size_t>(k)] = now;
    }
    return T.back();
  }
};

/// Gauss' collocation with four stages, iterated from one to the next as far as rounding lets it (the same,
/// section II.7).
class Collocation final : public SmoothMotion {
 public:
  Collocation(const Dynamics& dynamics, const State& start) : SmoothMotion(dynamics, start) {
    // The zeros of Legendre's polynomial of degree 4; integrals of Lagrange's polynomials to each, and to 1.
    const double near = std::sqrt(3.0 / 7 - 2.0 / 7 * std::sqrt(1.2)),
                 far = std::sqrt(3.0 / 7 + 2.0 / 7 * std::sqrt(1.2));
    c_ = (Weights(-far, -near, near, far).array() + 1) / 2;
    Eigen::Matrix4d powers, integrals;
    Weights whole;
    for (int k = 0; k < kStages; ++k) {
      powers.col(k) = c_.array().pow(k);
      integrals.col(k) = c_.array().pow(k + 1) / (k + 1);
      whole[k] = 1.0 / (k + 1);
    }
    a_ = integrals * powers.inverse();
    b_ = powers.transpose().inverse() * whole;
  }

 private:
  static constexpr int kStages = 4, kMostIterations = 40;
  static constexpr double kConverged = 1e-3;
  using Weights = Eigen::Vector4d;

  VecX<double> change(double t, double h) override {
    MatX<double> k = rates(t, y()) * Eigen::RowVector4d::Ones(), before;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMostIterations; ++i) {
      before = k;
      const MatX<double> at = h * before * a_.transpose();
      for (int s = 0; s < kStages; ++s) k.col(s) = rates(t + c_[s] * h, y() + at.col(s));
      const double moved = (k - before).norm();
      if (!(moved < least)) break;
      least = moved;
    }
    // A diverging iteration is refused. The bound is not tighter, because four-bars does not reach 1e-8 near
    // its singular positions; the other method measures the accuracy.
    if (!(least <= kConverged * k.norm())) k.setConstant(std::numeric_limits<double>::quiet_NaN());
    return h * k * b_;
  }

  Weights c_, b_;
  Eigen::Matrix4d a_;
};

}  // namespace pliant::bench
