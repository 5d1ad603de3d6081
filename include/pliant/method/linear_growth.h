// Growth of a one-step method on x'' + D x' + K x = 0 by its stability function.
#pragma once

#include <algorithm>
#include <complex>

#include <pliant/math/eigenvalues.h>

namespace pliant {

/// Returns the largest |R(z)|, z = h times an eigenvalue of the motion; stability: R(z).
template <class Stability>
double linear_growth(const MatX<double>& K, const MatX<double>& D, double h, Stability&& stability) {
  const Eigen::Index n = K.rows();
  MatX<double> A(2 * n, 2 * n);
  A << MatX<double>::Zero(n, n), MatX<double>::Identity(n, n), -K, -D;
  double worst = 0;
  for (const std::complex<double>& lambda : eigenvalues(A))
    worst = std::max(worst, std::abs(stability(h * lambda)));
  return worst;
}

}  // namespace pliant
