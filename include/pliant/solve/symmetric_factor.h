// Factorisation L D L^T of a small symmetric mass matrix M, Eq. (11), in which some coordinates may have no
// inertia. A coordinate whose pivot vanishes moves no mass at present (for example the direction of a bend
// with zero angle). This coordinate is excluded: its acceleration is 0, and the other coordinates are solved
// without it.
#pragma once

#include <array>
#include <bitset>

#include <pliant/math/scalar/dual.h>
#include <pliant/math/types.h>

namespace pliant {

/// The factor of a matrix with at most kMaxVelocities rows.
template <class S>
class SymmetricFactor {
 public:
  /// Relative size, with respect to the diagonal entry, at or below which a pivot vanishes.
  static constexpr double kVanished = 1e-12;

  /// Factors A, n x n. floor: n numbers; a coordinate whose diagonal entry is at or below floor_i has no
  /// inertia in the units of the model.
  template <class Matrix>
  void compute(const Matrix& A, const VecX<double>& floor) {
    n_ = static_cast<int>(A.rows());
    excluded_.reset();
    rows_.resize(n_ * (n_ + 1) / 2);
    S* L = rows_.data();
    for (int i = 0; i < n_; L += ++i) {
      const S* row_j = rows_.data();
      for (int j = 0; j < i; row_j += ++j) {
        S sum = A(i, j);
        for (int k = 0; k < j; ++k) sum -= L[k] * row_j[k];
        L[j] = excluded(j) ? S(0.0) : sum;  // L_ij D_j
      }
      S d = A(i, i);
      const S* diagonal = rows_.data();
      for (int k = 0; k < i; diagonal += ++k + 1) {
        const S scaled = L[k] * *diagonal;
        d -= L[k] * scaled;
        L[k] = scaled;
      }
      const double entry = plain(A(i, i));
      // A NaN excludes no coordinate; the check of the solution for finite numbers detects the NaN.
      const bool vanished = entry == entry && (!(entry > floor[i]) || !(plain(d) > kVanished * entry));
      L[i] = vanished ? S(1.0) : S(1.0) / d;
      if (!vanished) continue;
      excluded_.set(static_cast<std::size_t>(i));
      for (int k = 0; k < i; ++k) L[k] = S(0.0);
    }
  }

  /// Computes x = A^-1 x, with zeros for excluded coordinates.
  template <class Vector>
  void solve(Vector&& x) const {
    solve_columns<1>(x.data());
  }
  /// Solves for several columns, which are stored one after the other in x.
  template <int Columns>
  void solve_columns(S* x) const {
    const S* L = rows_.data();
    for (int i = 0; i < n_; L += ++i) {
      std::array<S, Columns> sum{};
      for (int c = 0; c < Columns; ++c) sum[c] = excluded(i) ? S(0.0) : x[c * n_ + i];
      for (int k = 0; k < i; ++k)
        for (int c = 0; c < Columns; ++c) sum[c] -= L[k] * x[c * n_ + k];
      for (int c = 0; c < Columns; ++c) x[c * n_ + i] = sum[c];
    }
    L = rows_.data();
    for (int i = 0; i < n_; L += ++i)
      for (int c = 0; c < Columns; ++c) x[c * n_ + i] = x[c * n_ + i] * L[i];
    for (int i = n_ - 1; i > 0; --i) {
      L -= i + 1;
      for (int c = 0; c < Columns; ++c)
        for (int k = 0; k < i; ++k) x[c * n_ + k] -= L[k] * x[c * n_ + i];
    }
  }

  /// Returns whether coordinate i is excluded.
  bool excluded(int i) const { return excluded_.test(static_cast<std::size_t>(i)); }
  bool any_excluded() const { return excluded_.any(); }

 private:
  int n_ = 0;
  /// L by rows, with 1 / D_i in place of the unit diagonal. The array is on the heap, so that the workspaces
  /// of the parts of a chain are close together in memory.
  VecX<S> rows_;
  std::bitset<kMaxVelocities> excluded_;
};

}  // namespace pliant
