// The active-set method for one-sided rows.
#pragma once

#include <pliant/solve/complementarity.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include <pliant/math/scalar/power_of_two.h>

namespace pliant {

namespace detail {

/// Rounding error of W lambda + b in a row, relative to the sum of the absolute values of its terms. A row
/// that is violated by at most this error is treated as satisfied.
inline constexpr double kComplementarityRounding = 1e-14;
/// A row depends on the active rows if its Schur complement is at most this fraction of its diagonal entry.
inline constexpr double kDependentOneSidedRow = 1e-12;

/// The impulses and the set of active rows (W lambda + b = 0).
template <int Max>
class ActiveSet {
  using Matrix = MatMax<double, Max>;
  using Vector = VecMax<double, Max>;

 public:
  ActiveSet(const Matrix& W, const Vector& b)
      : W_(W),
        b_(b),
        lambda_(Vector::Zero(b.size())),
        active_(b.size()),
        is_active_(VecMax<int, Max>::Zero(b.size())),
        excluded_(VecMax<int, Max>::Zero(b.size())) {}

  /// Returns the row with the largest violation^2 / W_ii, or -1 if no row is violated. Skips active rows,
  /// excluded rows and rows with W_ii <= 0.
  int most_violated() const {
    int worst = -1;
    double largest = 0;
    for (int i = 0; i < b_.size(); ++i) {
      if (excluded_[i] != 0 || is_active_[i] != 0 || !(W_(i, i) > 0)) continue;
      double slack = b_[i], terms = std::abs(b_[i]);
      for (int k = 0; k < n_; ++k) {
        const double term = W_(i, active_[k]) * lambda_[active_[k]];
        slack += term;
        terms += std::abs(term);
      }
      const double violation = slack < -kComplementarityRounding * terms ? slack * slack / W_(i, i) : 0;
      if (violation > largest) {
        worst = i;
        largest = violation;
      }
    }
    return worst;
  }

  /// Makes row j active, or excludes it if it contradicts the active rows. Other rows can be released on the
  /// way. Returns the number of linear systems solved.
  int activate(int j) {
    for (int solved = 1;; ++solved) {
      // W_PP y = W_Pj: the decrease of the impulses of the active rows P for a unit impulse of row j.
      Vector y(n_);
      for (int k = 0; k < n_; ++k) y[k] = W_(active_[k], j);
      solve_active(y);
      double pivot = W_(j, j), slack = b_[j] + W_(j, j) * lambda_[j];
      for (int k = 0; k < n_; ++k) {
        pivot -= W_(j, active_[k]) * y[k];
        slack += W_(j, active_[k]) * lambda_[active_[k]];
      }
      // The step ends when row j is satisfied. It ends earlier if the impulse of an active row becomes zero
      // before that; this row is released.
      const bool dependent = !(pivot > kDependentOneSidedRow * W_(j, j));
      double step = dependent ? -1 : std::max(0.0, -slack / pivot);
      int released = -1;
      for (int k = 0; k < n_; ++k) {
        if (!(y[k] > 0)) continue;
        const double limit = lambda_[active_[k]] / y[k];
        if (step < 0 || limit < step) {
          step = limit;
          released = k;
        }
      }
      if (step < 0) {  // the row contradicts the active rows: no impulse satisfies it
        excluded_[j] = 1;
        lambda_[j] = 0;
        return solved;
      }
      lambda_[j] += step;
      for (int k = 0; k < n_; ++k) lambda_[active_[k]] -= step * y[k];
      if (released < 0) {
        active_[n_++] = j;
        is_active_[j] = 1;
        refine();
        return solved;
      }
      release(released);
    }
  }

  const Vector& lambda() const { return lambda_; }

 private:
  /// Makes the active row number k inactive, with impulse 0.
  void release(int k) {
    lambda_[active_[k]] = 0;
    is_active_[active_[k]] = 0;
    for (--n_; k < n_; ++k) active_[k] = active_[k + 1];
  }
  /// Solves W_PP x = x for the active rows P.
  void solve_active(Vector& x) const {
    if (n_ == 0) return;
    Matrix block(n_, n_);
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) block(i, j) = W_(active_[i], active_[j]);
    const Vector scale = equalising_scales(block.diagonal());
    const Eigen::LDLT<Matrix> factor(scale.asDiagonal() * block * scale.asDiagonal());
    x = scale.cwiseProduct(factor.solve(scale.cwiseProduct(x)));
  }
  /// Recomputes the impulses of the active rows, so that rounding does not accumulate over many changes.
  void refine() {
    Vector x(n_);
    for (int k = 0; k < n_; ++k) x[k] = -b_[active_[k]];
    solve_active(x);
    for (int k = 0; k < n_; ++k) lambda_[active_[k]] = std::max(0.0, x[k]);
  }

  const Matrix& W_;
  const Vector& b_;
  Vector lambda_;
  int n_ = 0;  ///< number of active rows; active_ lists them in the order of activation
  VecMax<int, Max> active_, is_active_, excluded_;
};

}  // namespace detail

template <int Max>
ComplementarityResult<Max> solve_complementarity(const MatMax<double, Max>& W, const VecMax<double, Max>& b) {
  ComplementarityResult<Max> result;
  detail::ActiveSet<Max> rows(W, b);
  const int n = static_cast<int>(b.size()), max_pivots = 50 * n + 50;
  for (int next = rows.most_violated(); next >= 0 && result.pivots < max_pivots; next = rows.most_violated())
    result.pivots += rows.activate(next);
  result.lambda = rows.lambda();
  for (int i = 0; i < n; ++i) {
    double slack = b[i];
    for (int j = 0; j < n; ++j) slack += W(i, j) * result.lambda[j];
    const double push = result.lambda[i] * W(i, i);
    result.residual = std::max({result.residual, -slack, -push, std::min(push, slack)});
  }
  return result;
}

}  // namespace pliant
