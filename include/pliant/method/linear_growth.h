// Growth of a one-step method on x'' + D x' + K x = 0 by its stability function (Hairer & Wanner, Solving
// Ordinary Differential Equations II, section IV.2).
#pragma once

#include <algorithm>
#include <complex>

#include <pliant/math/eigenvalues.h>

namespace pliant {

/// Returns the largest |R(z)| over z = h lambda, for the eigenvalues lambda (1/s) of x'' + D x' + K x = 0.
/// stability: the function R(z). K: 1/s^2, D: 1/s, n x n each; h: s.
template <class Stability>
double linear_growth(const MatX<double>& K, const MatX<double>& D, double h, Stability&& stability) {
  const Eigen::Index n = K.rows();
  MatX<double> A(2 * n, 2 * n);
  A << MatX<double>::Zero(n, n), MatX<double>::Identity(n, n), -K, -D;
  double largest = 0;
  for (const std::complex<double>& lambda : eigenvalues(A))
    largest = std::max(largest, std::abs(stability(h * lambda)));
  return largest;
}

}  // namespace pliant
