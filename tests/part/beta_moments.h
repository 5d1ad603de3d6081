// Closed forms of the moments of a superellipsoid by Beta functions, in long double.
#pragma once

#include <cmath>

namespace pliant::test {

inline long double beta(long double x, long double y) {
  return std::exp(std::lgamma(x) + std::lgamma(y) - std::lgamma(x + y));
}

/// Returns the integral of x^i y^j z^k over a superellipsoid with the semi-axes a. i, j and k must be even.
inline long double moment(const long double a[3], long double eps1, long double eps2, int i, int j, int k) {
  return std::pow(a[0], i + 1) * std::pow(a[1], j + 1) * std::pow(a[2], k + 1) * eps1 * eps2 /
         (i + j + k + 3) * beta((i + j + 2) * eps1 / 2, (k + 1) * eps1 / 2) * 2 *
         beta((i + 1) * eps2 / 2, (j + 1) * eps2 / 2);
}

/// Returns the logarithmic derivative of Gamma.
inline long double digamma(long double x) {
  long double shift = 0;
  for (; x < 20; x += 1) shift -= 1 / x;
  const long double y = 1 / (x * x);
  return shift + std::log(x) - 0.5L / x -
         y * (1 / 12.0L -
              y * (1 / 120.0L - y * (1 / 252.0L - y * (1 / 240.0L - y * (1 / 132.0L - y * 691 / 32760.0L)))));
}

}  // namespace pliant::test
