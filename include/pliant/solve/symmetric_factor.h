// L D L^T of a small symmetric mass matrix that may lack inertia in some coordinates (design 1.3): a
// coordinate whose pivot vanishes moves nothing right now; it is held, and everything else is solved as if it
// were not there.
#pragma once

#include <array>
#include <bitset>

#include <pliant/math/scalar/dual.h>
#include <pliant/math/types.h>

namespace pliant {

template <class S>
class SymmetricFactor {
 public:
  /// Pivots below this part of their diagonal entry count as vanished.
  static constexpr double kVanished = 1e-12;

  /// Factors A. floor_i: a diagonal entry at or below it has no inertia in this model's units.
  template <class Matrix>
  void compute(const Matrix& A, const VecX<double>& floor) {
    n_ = static_cast<int>(A.rows());
    held_.reset();
    rows_.resize(n_ * (n_ + 1) / 2);
    S* L = rows_.data();
    for (int i = 0; i < n_; L += ++i) {
      const S* of_j = rows_.data();
      for (int j = 0; j < i; of_j += ++j) {
        S sum = A(i, j);
        for (int k = 0; k < j; ++k) sum -= L[k] * of_j[k];
        L[j] = held(j) ? S(0.0) : sum;  // L_ij D_j
      }
      S d = A(i, i);
      const S* diagonal = rows_.data();
      for (int k = 0; k < i; diagonal += ++k + 1) {
        const S scaled = L[k] * *diagonal;
        d -= L[k] * scaled;
        L[k] = scaled;
      }
      const double entry = plain(A(i, i));
      // What is not a number is left to the finite check.
      const bool gone = entry == entry && (!(entry > floor[i]) || !(plain(d) > kVanished * entry));
      L[i] = gone ? S(1.0) : S(1.0) / d;
      if (!gone) continue;
      held_.set(static_cast<std::size_t>(i));
      for (int k = 0; k < i; ++k) L[k] = S(0.0);
    }
  }

  /// x = A^-1 x, with zeros for held coordinates.
  template <class Vector>
  void solve(Vector&& x) const {
    solve_columns<1>(x.data());
  }
  /// The same of several columns, which lie one after the other in x.
  template <int Columns>
  void solve_columns(S* x) const {
    const S* L = rows_.data();
    for (int i = 0; i < n_; L += ++i) {
      std::array<S, Columns> sum{};
      for (int c = 0; c < Columns; ++c) sum[c] = held(i) ? S(0.0) : x[c * n_ + i];
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

  bool held(int i) const { return held_.test(static_cast<std::size_t>(i)); }
  bool any_held() const { return held_.any(); }

 private:
  int n_ = 0;
  /// L by rows, with 1 / D_i in the place of its unit diagonal. On the heap, so that the parts of a chain lie
  /// close together.
  VecX<S> rows_;
  std::bitset<kMaxVelocities> held_;
};

}  // namespace pliant
