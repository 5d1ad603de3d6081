// Sine, cosine and exponential by additions and multiplications only, for a double or for a Pack. Each lane
// of a Pack has the same bits as the result for a double, on every machine; four lanes cost about as much as
// one double. The measured errors are below one unit in the last place (tests/math/scalars.cpp). Method: the
// argument is reduced by multiples of pi/2 or log 2, which are split into constants with few bits (Cody &
// Waite 1980); Taylor series are evaluated at the reduced argument.
#pragma once

#ifdef __FAST_MATH__
#error "pliant needs IEEE arithmetic in the written order: compile without -ffast-math"
#endif

#include <cstdint>
#include <cstring>

namespace pliant::math {

/// Returns x if c > 0, else y. A Pack selects lane by lane; a Dual or Taylor2 selects the derivatives too.
inline double select_positive(double c, double x, double y) {
  return c > 0 ? x : y;
}
inline long double select_positive(long double c, long double x, long double y) {
  return c > 0 ? x : y;
}
template <class T>
inline T where_positive(const T& c, const T& x, const T& y) {
  return select_positive(c, x, y);
}
template <class T>
inline T abs(const T& x) {
  return where_positive(x, x, T(-x));
}

namespace elementary {

/// After the addition of this constant to a number x, |x| < 2^51, the last bits of the sum are the nearest
/// integer.
inline constexpr double kRounder = 0x1.8p52;

/// Returns the integer nearest to x, |x| < 2^51.
template <class T>
inline T nearest_integer(const T& x) {
  return (x + kRounder) - kRounder;
}

/// Returns 2^n for an integer -1023 < n < 1024.
inline double power_of_two(double n) {
  const double shifted = n + kRounder;
  std::uint64_t bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 1023) << 52;
  double power;
  std::memcpy(&power, &bits, sizeof power);
  return power;
}

/// Returns the sum of c_k x^k, N even. Even and odd powers are two independent sums, which run in parallel on
/// the arithmetic units.
template <class T, int N>
inline T polynomial(const double (&c)[N], const T& x) {
  static_assert(N % 2 == 0);
  const T x2 = x * x;
  T even(c[N - 2]), odd(c[N - 1]);
  for (int k = N - 4; k >= 0; k -= 2) {
    even = even * x2 + c[k];
    odd = odd * x2 + c[k + 1];
  }
  return even + odd * x;
}

/// Returns e^x for every x.
template <class T>
inline T exp(const T& x) {
  constexpr double log2_e = 0x1.71547652b82fep+0, ln2_high = 0x1.62e42fefp-1, ln2_low = 0x1.473de6af278edp-34;
  // coefficients of (e^r - 1 - r) / r^2
  constexpr double series[] = {1. / 2,       1. / 6,        1. / 24,        1. / 120,
                               1. / 720,     1. / 5040,     1. / 40320,     1. / 362880,
                               1. / 3628800, 1. / 39916800, 1. / 479001600, 1. / 6227020800};
  const T lowest(-746), highest(710);  // e^x is 0 below and infinite above; NaN passes through
  const T above = where_positive(T(lowest - x), lowest, x);
  const T clamped = where_positive(T(above - highest), highest, above);
  const T n = nearest_integer(T(clamped * log2_e));
  const T r = (clamped - n * ln2_high) - n * ln2_low;
  const T e = r * r * polynomial(series, r) + r + 1.0;
  const T half = nearest_integer(T(n * 0.5));  // 2^n as two factors keeps subnormal results accurate
  return e * power_of_two(half) * power_of_two(T(n - half));
}

/// The largest |x| (rad) for which the argument reduction of sin_cos is accurate.
inline constexpr double kLargestAngle = 1e6;

/// Computes sine and cosine of x (rad), |x| <= kLargestAngle.
template <class T>
inline void sin_cos(const T& x, T& sine, T& cosine) {
  constexpr double two_over_pi = 0x1.45f306dc9c883p-1;
  constexpr double high = 0x1.921fb544p+0, middle = 0x1.0b4611a6p-34, low = 0x1.3198a2e037073p-69;  // pi/2
  // coefficients of (sin r - r) / r^3 and (cos r - 1 + r^2/2) / r^4, as series in r^2
  constexpr double sine_series[] = {
      -1. / 6,        1. / 120,        -1. / 5040,          1. / 362880,
      -1. / 39916800, 1. / 6227020800, -1. / 1307674368000, 1. / 355687428096000};
  constexpr double cosine_series[] = {
      1. / 24,        -1. / 720,         1. / 40320,           -1. / 3628800,
      1. / 479001600, -1. / 87178291200, 1. / 20922789888000., -1. / 6402373705728000.};
  const T n = nearest_integer(T(x * two_over_pi));
  // r + rest = x - n pi/2. The products with `high` and `middle` and the first difference are exact.
  const T near = x - n * high, step = n * middle;
  const T reduced = near - step, moved = reduced - near;
  const T rounding = (near - (reduced - moved)) - (step + moved);
  const T correction = rounding - n * low;
  const T r = reduced + correction;
  const T rest = (reduced - r) + correction;
  const T r2 = r * r, half = r2 * 0.5;
  const T s = r + (r * r2 * polynomial(sine_series, r2) + rest * (-half + 1.0));
  const T less = -half + 1.0;
  const T c = less + (((-less + 1.0) - half) + (r2 * r2 * polynomial(cosine_series, r2) - r * rest));
  // Number of quarter turns, -2 to 2; an odd number swaps sine and cosine.
  const T quarters = n - nearest_integer(T(n * 0.25)) * 4.0;
  const T size = abs(quarters), even = -size + 1.0;
  const T odd = -abs(even) + 0.5;
  sine = where_positive(odd, T(c * quarters), T(s * even));
  cosine = where_positive(odd, T(-s * quarters), T(c * even));
}

}  // namespace elementary

}  // namespace pliant::math
