// Reference solutions of smooth motions to nearly full precision, by two methods of order 8, which pliant
// does not contain. Both methods use the accelerations of pliant only, without projection.
#pragma once

#include <array>
#include <cmath>
#include <limits>

#include <pliant/pliant.h>

namespace pliant::bench {

/// The motion y = (q, v) from an initial state. Joints and limits of parameters keep the modes (closed,
/// active and so on) of the initial state.
class SmoothMotion {
 public:
  SmoothMotion(const Dynamics& dynamics, const State& start)
      : dynamics_(dynamics), modes_(start), n_q_(start.q.size()), y_(n_q_ + start.v.size()) {
    y_ << start.q, start.v;
    compensation_.setZero(y_.size());
  }
  virtual ~SmoothMotion() = default;
  VecX<double> q() const { return y_.head(n_q_); }
  VecX<double> v() const { return y_.tail(y_.size() - n_q_); }
  /// Advances from time t to t + h.
  void step(double t, double h) {
    // The change of y within a step is computed separately from y, so that the rounding of y does not affect
    // the change. Kahan's compensated summation adds the change to y.
    const VecX<double> compensated = change(t, h) + compensation_;
    const VecX<double> sum = y_ + compensated;
    compensation_ = compensated - (sum - y_);
    y_ = sum;
  }

 protected:
  /// Returns y(t + h) - y(t).
  virtual VecX<double> change(double t, double h) = 0;
  const VecX<double>& y() const { return y_; }
  /// Returns y_dot at (t, y).
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
  VecX<double> y_, compensation_;
  VecX<double> q_, v_, q_dot_;
  Workspace<double> work_;
};

/// Gragg's midpoint rule with extrapolation (Hairer, Norsett & Wanner, Solving Ordinary Differential
/// Equations I, section II.9).
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
      VecX<double> previous = VecX<double>::Zero(slope.size()), latest = h * slope;
      for (int i = 1; i < n; ++i) {
        previous += 2 * h * rates(t + i * h, y() + latest);
        previous.swap(latest);
      }
      for (int j = 1; j <= k; ++j) {
        const double ratio = static_cast<double>(k + 1) / (k + 1 - j);
        VecX<double>& coarser = T[static_cast<std::size_t>(j - 1)];
        const VecX<double> better = latest + (latest - coarser) / (ratio * ratio - 1);
        coarser.swap(latest);
        latest = better;
      }
      T[static_cast<std::size_t>(k)] = latest;
    }
    return T.back();
  }
};

/// Gauss collocation with four stages (Hairer, Norsett & Wanner, section II.7). The stages are iterated until
/// rounding prevents further convergence.
class Collocation final : public SmoothMotion {
 public:
  Collocation(const Dynamics& dynamics, const State& start) : SmoothMotion(dynamics, start) {
    // c_: the zeros of the Legendre polynomial of degree 4, mapped to [0, 1]. a_ and b_: the integrals of
    // the Lagrange polynomials from 0 to each zero, and from 0 to 1.
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
  static constexpr int kStages = 4, kMaxIterations = 40;
  static constexpr double kConverged = 1e-3;
  using Weights = Eigen::Vector4d;

  VecX<double> change(double t, double h) override {
    MatX<double> k = rates(t, y()) * Eigen::RowVector4d::Ones(), previous;
    double smallest_change = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxIterations; ++i) {
      previous = k;
      const MatX<double> increment = h * previous * a_.transpose();
      for (int s = 0; s < kStages; ++s) k.col(s) = rates(t + c_[s] * h, y() + increment.col(s));
      const double change_norm = (k - previous).norm();
      if (!(change_norm < smallest_change)) break;
      smallest_change = change_norm;
    }
    // If the iteration diverges, the result is NaN. The threshold is large because the iteration does not
    // converge to 1e-8 for the problem "four-bars" (problems.h) near its singular positions. The comparison
    // with the other method shows the accuracy of a solution.
    if (!(smallest_change <= kConverged * k.norm())) k.setConstant(std::numeric_limits<double>::quiet_NaN());
    return h * k * b_;
  }

  Weights c_, b_;
  Eigen::Matrix4d a_;
};

}  // namespace pliant::bench
