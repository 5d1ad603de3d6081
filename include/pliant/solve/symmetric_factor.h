// L D L^T of a small symmetric mass matrix that may lack inertia in some coordinates (design 1.3): a
// coordinate whose pivot vanishes moves nothing right now; it is held, and everything else is solved as if it
// were not there.
#pragma once

#include <bitset>

#include <pliant/math/dual.h>
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
    L_.resize(n_, n_);
    D_.resize(n_);
    for (int j = 0; j < n_; ++j) {
      S d = A(j, j);
      for (int k = 0; k < j; ++k) d -= L_(j, k) * L_(j, k) * D_[k];
      const double diagonal = plain(A(j, j));
      if (!(diagonal > floor[j]) || !(plain(d) > kVanished * diagonal)) {
        if (diagonal == diagonal)
          held_.set(static_cast<std::size_t>(j));  // not a number: leave it to the finite check
      }
      D_[j] = d;
      const bool gone = held_.test(static_cast<std::size_t>(j));
      if (gone) D_[j] = S(1.0);
      for (int i = j + 1; i < n_; ++i) {
        S sum = A(i, j);
        for (int k = 0; k < j; ++k) sum -= L_(i, k) * L_(j, k) * D_[k];
        L_(i, j) = gone ? S(0.0) : S(sum / D_[j]);
      }
      if (gone)
        for (int k = 0; k < j; ++k) L_(j, k) = S(0.0);
    }
  }

  /// x = A^-1 x, with zeros for held coordinates.
  template <class Vector>
  void solve(Vector&& x) const {
    for (int i = 0; i < n_; ++i) {
      if (held_.test(static_cast<std::size_t>(i))) x[i] = S(0.0);
      for (int k = 0; k < i; ++k) x[i] -= L_(i, k) * x[k];
    }
    for (int i = 0; i < n_; ++i) x[i] = x[i] / D_[i];
    for (int i = n_ - 1; i >= 0; --i)
      for (int k = i + 1; k < n_; ++k) x[i] -= L_(k, i) * x[k];
  }

  bool held(int i) const { return held_.test(static_cast<std::size_t>(i)); }
  bool any_held() const { return held_.any(); }

 private:
  int n_ = 0;
  // On the heap, so that the parts of a chain lie close together.
  MatX<S> L_;
  VecX<S> D_;
  std::bitset<kMaxVelocities> held_;
};

}  // namespace pliant
