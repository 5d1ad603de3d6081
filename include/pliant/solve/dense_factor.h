// Factorisation L D L^T of a dense symmetric positive semi-definite matrix, in panels of columns, with
// symmetric exchanges of rows that have small pivots (Pivots::kSmall). S is double or Dual<1>.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

#include <pliant/math/index.h>
#include <pliant/math/types.h>
#include <pliant/solve/pivots.h>

namespace pliant {

/// A dense matrix; after factor() its factor.
template <class S>
class DenseFactor {
 public:
  /// Returns the matrix to factor; after factor() its factor. Only the lower triangle is used.
  MatX<S>& matrix() { return L_; }

  /// Factors the matrix in place. row: for each row of the matrix, its index in `pivots`.
  void factor(const std::vector<int>& row, Pivots<S>& pivots) {
    const auto n = static_cast<int>(L_.rows());
    row_ = row;
    scaled_.resize(n, kPanel);
    for (int first = 0; first < n; first += kPanel) {
      const int last = std::min(first + kPanel, n);
      for (int j = first; j < last; ++j) {
        const int below = n - j - 1;
        exchange_small_pivot(first, j, pivots);
        for (int k = first; k < j; ++k)
          L_.col(j).tail(n - j) -= scaled_.col(k - first).tail(n - j) * L_(j, k);
        scaled_.col(j - first).tail(below) = L_.col(j).tail(below);
        if (!pivots.accept(row_[at(j)], L_(j, j))) scaled_.col(j - first).tail(below).setZero();
        L_.col(j).tail(below) = scaled_.col(j - first).tail(below) * pivots.inverse(row_[at(j)]);
      }
      if (last == n) break;
      int j = last;
      for (; j + 1 < n; j += 2) subtract_panel(first, j);
      if (j < n) L_(j, j) -= scaled_.row(j).dot(L_.template block<1, kPanel>(j, first));
    }
  }

  /// Returns, for each row of the factor, its index in the pivots: the argument `row` of factor() after the
  /// exchanges.
  const std::vector<int>& rows() const { return row_; }

  /// Computes x = A^-1 x for the factored matrix A, with zeros for excluded rows. x is in the order of
  /// rows().
  void solve(const Pivots<S>& pivots, VecX<S>& x) const {
    const auto n = static_cast<int>(L_.rows());
    for (int j = 0; j < n; ++j) x.tail(n - j - 1) -= L_.col(j).tail(n - j - 1) * x[j];
    for (int j = n; j-- > 0;) {
      x[j] *= pivots.inverse(row_[at(j)]);
      x[j] -= L_.col(j).tail(n - j - 1).dot(x.tail(n - j - 1));
    }
  }

 private:
  static constexpr int kPanel = 4;

  /// If the pivot of row j is small, exchanges the row with the remaining row whose ratio of pivot to scale
  /// is largest. first: the first column of the panel.
  void exchange_small_pivot(int first, int j, const Pivots<S>& pivots) {
    auto pivot = [&](int i) {
      S d = L_(i, i);
      for (int k = first; k < j; ++k) d -= scaled_(i, k - first) * L_(i, k);
      return d;
    };
    const S own = pivot(j);
    if (!pivots.small(row_[at(j)], own)) return;
    int best = j;
    double largest = pivots.ratio(row_[at(j)], own);
    for (int i = j + 1; i < static_cast<int>(L_.rows()); ++i) {
      const double ratio = pivots.ratio(row_[at(i)], pivot(i));
      if (ratio > largest) largest = ratio, best = i;
    }
    if (best != j) exchange(first, j, best);
  }

  /// Exchanges the rows and columns j and p > j of the matrix whose columns before j are factored.
  void exchange(int first, int j, int p) {
    const int below = static_cast<int>(L_.rows()) - p - 1;
    std::swap(row_[at(j)], row_[at(p)]);
    std::swap(L_(j, j), L_(p, p));
    L_.row(j).head(j).swap(L_.row(p).head(j));
    scaled_.row(j).head(j - first).swap(scaled_.row(p).head(j - first));
    for (int i = j + 1; i < p; ++i) std::swap(L_(i, j), L_(p, i));
    L_.col(j).tail(below).swap(L_.col(p).tail(below));
  }

  /// Subtracts the product of a panel from two columns to its right. Each number of the panel is loaded once
  /// for both columns.
  void subtract_panel(int first, int j) {
    const auto rows = static_cast<int>(L_.rows()) - j;
    const S *x0 = &scaled_(j, 0), *x1 = &scaled_(j, 1), *x2 = &scaled_(j, 2), *x3 = &scaled_(j, 3);
    const Eigen::Matrix<S, kPanel, 1> l = L_.template block<1, kPanel>(j, first),
                                      m = L_.template block<1, kPanel>(j + 1, first);
    const S l0 = l[0], l1 = l[1], l2 = l[2], l3 = l[3], m0 = m[0], m1 = m[1], m2 = m[2], m3 = m[3];
    S *y = &L_(j, j), *z = &L_(j, j + 1);
    for (int i = 0; i < rows; ++i) {
      y[i] -= (x0[i] * l0 + x1[i] * l1) + (x2[i] * l2 + x3[i] * l3);
      z[i] -= (x0[i] * m0 + x1[i] * m1) + (x2[i] * m2 + x3[i] * m3);
    }
  }

  MatX<S> L_;
  std::vector<int> row_;                             ///< see rows()
  Eigen::Matrix<S, Eigen::Dynamic, kPanel> scaled_;  ///< L D for one panel
};

}  // namespace pliant
