// Powers of two as scales of the rows and columns of a matrix. Multiplication by a power of two causes no
// rounding. Scales make rows comparable, so that the choice of pivots hardly depends on units.
#pragma once

#include <cmath>

#include <pliant/math/types.h>

namespace pliant {

/// Returns the largest power of two that is at most |x|; 1 if x is zero or not finite.
inline double power_of_two(double x) {
  if (x == 0 || !std::isfinite(x)) return 1;
  return std::ldexp(1.0, std::ilogb(x));
}

/// Returns factors s, powers of two, that equalise the diagonal d of a symmetric matrix: all numbers s_i^2
/// |d_i| are in [1/2, 4). Let a change of units multiply each d_i by a power of four of its own, and all d_i
/// by one common power of two. Then all numbers s_i^2 |d_i| change by at most one common power of two.
template <class Vector>
typename Vector::PlainObject equalising_scales(const Eigen::MatrixBase<Vector>& d) {
  const auto exponent = [&](Eigen::Index i) {
    return d[i] == 0 || !std::isfinite(d[i]) ? 0 : std::ilogb(d[i]);
  };
  typename Vector::PlainObject s(d.size());
  const int odd = d.size() > 0 ? exponent(0) & 1 : 0;
  for (Eigen::Index i = 0; i < d.size(); ++i) {
    const int sum = exponent(i) + odd;
    s[i] = std::ldexp(1.0, -(sum - (sum & 1)) / 2);
  }
  return s;
}

}  // namespace pliant
