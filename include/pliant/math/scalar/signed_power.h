// Signed powers sgn(x) |x|^eps of a sine or cosine x. The formulas of the superquadrics consist of these
// powers (include/pliant/shape/README.md). Each x is stored with log |x|, so that a power costs one
// exponential, and 0^eps log 0 is 0 and never NaN.
#pragma once

#include <limits>

#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/functions.h>
#include <pliant/math/scalar/taylor2.h>

namespace pliant {

/// A cosine or sine of a material angle, with its sign and the logarithm of its absolute value.
template <class U = double>
struct Trig {
  U x{};        ///< the value, in [-1, 1]; exactly 0 if the angle is a root of the cosine or sine
  U sign{};     ///< -1, 0 or 1
  U log_abs{};  ///< log |x|; kLogZero for x = 0
};

/// Represents log 0. The value is finite, so that 0 * log 0 is 0; exp(eps * kLogZero) is 0 for all admissible
/// exponents.
inline constexpr double kLogZero = -1e6;

/// Returns the Trig whose value is sign * exp(log_abs).
inline Trig<double> trig_from_log(double log_abs, double sign) {
  return {sign * math::exp(log_abs), sign, log_abs};
}

/// Returns x with its sign and log |x|.
inline Trig<double> trig(double x) {
  const double sign = x > 0 ? 1.0 : (x < 0 ? -1.0 : 0.0);
  return {x, sign, sign != 0 ? std::log(std::abs(x)) : kLogZero};
}

/// Returns sgn(x) |x|^eps. T is the scalar of the exponent.
template <class T, class U>
T signed_power(const Trig<U>& c, const T& eps) {
  return math::exp(T(eps * c.log_abs)) * c.sign;
}

/// Returns sgn(x) |x|^eps with derivatives: d/d eps multiplies the power by log |x|.
template <int N, class T, class U>
Dual<N, T> signed_power(const Trig<U>& c, const Dual<N, T>& eps) {
  const T p = signed_power(c, eps.v);
  return chain_rule(eps, p, T(p * c.log_abs));
}
template <class T, class U>
Taylor2<T> signed_power(const Trig<U>& c, const Taylor2<T>& eps) {
  const T p = signed_power(c, eps.v), slope = p * c.log_abs;
  return chain_rule(eps, p, slope, T(slope * c.log_abs));
}

/// Returns sgn(x) |x|^eps with derivatives along material directions: eps |x|^(eps-1) dx, which is infinite
/// at x = 0 for eps < 1.
template <int N>
Dual<N> signed_power(const Trig<Dual<N>>& c, const Dual<N>& eps) {
  if (c.log_abs.v > kLogZero) return math::exp(Dual<N>(eps * c.log_abs)) * c.sign.v;
  const double slope = eps.v == 1 ? 1.0 : (eps.v > 1 ? 0.0 : std::numeric_limits<double>::infinity());
  Dual<N> r(0.0);
  for (std::size_t i = 0; i < N; ++i) r.d[i] = c.x.d[i] != 0 ? slope * c.x.d[i] : 0.0;
  return r;
}

/// Returns the power and its derivatives along material directions for any T, for example a Pack of material
/// points. x = 0 is not allowed.
template <int N, class T>
Dual<N, T> signed_power(const Trig<Dual<N, T>>& c, const Dual<N, T>& eps) {
  return math::exp(Dual<N, T>(eps * c.log_abs)) * c.sign.v;
}

/// Returns r^p for r >= 0 and p > 0; for r <= 1e-300 value and derivatives are 0.
template <class T>
T power_from_zero(const T& r, const T& p) {
  const T floor(1e-300);
  const T above = r - floor;
  return math::where_positive(above, T(math::exp(T(p * math::log(math::where_positive(above, r, T(1)))))),
                              T(0));
}

/// Returns (x^p + y^p)^(1/p) for x, y >= 0. The larger argument is factored out, so that no exponent causes
/// overflow. For x = y = 0 the result is 0.
template <class T>
T power_norm(const T& x, const T& y, const T& p) {
  const T big = math::max(x, y);
  const T ratio = math::min(x, y) / math::where_positive(big, big, T(1));
  return big * math::exp(T(math::log(T(power_from_zero(ratio, p) + 1.0)) / p));
}

}  // namespace pliant
