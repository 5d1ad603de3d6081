// sin(x)/x and atan(x)/x. The values and derivatives are finite and exact to rounding, also at x = 0.
// sin(x)/x is a power series for |x| <= 1 and the quotient elsewhere.
#pragma once

#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/taylor2.h>

namespace pliant {

/// The value of a function at a point and its first two derivatives.
template <class T>
struct Derivatives {
  T value, first, second;
};

/// Returns sin(x) / x and its derivatives, from x and its sine and cosine.
template <class T>
Derivatives<T> sinc_derivatives(const T& x, const math::SinCos<T>& sin_cos_x) {
  // S(y) = sum of c_k y^k with c_k = (-1)^k / (2k+1)! and y = x^2. Value: S; first derivative: 2 x S';
  // second: 2 S' + 4 y S''.
  constexpr double c[] = {1.,
                          -1. / 6,
                          1. / 120,
                          -1. / 5040,
                          1. / 362880,
                          -1. / 39916800,
                          1. / 6227020800,
                          -1. / 1307674368000,
                          1. / 355687428096000,
                          -1. / 121645100408832000,
                          1. / 51090942171709440000.};
  const T y = x * x;
  T S(c[10]), S1(0.0), half_S2(0.0);
  for (int k = 9; k >= 0; --k) {
    half_S2 = half_S2 * y + S1;
    S1 = S1 * y + S;
    S = S * y + c[k];
  }
  const T far = y - 1.0;
  const T inverse = T(1.0) / math::where_positive(far, x, T(1.0));
  const T value = sin_cos_x.sin * inverse;
  const T first = (sin_cos_x.cos - value) * inverse;
  return {math::where_positive(far, value, S), math::where_positive(far, first, T(x * S1 * 2.0)),
          math::where_positive(far, T(-value - first * inverse * 2.0), T(S1 * 2.0 + y * half_S2 * 8.0))};
}

/// Returns sin(x) / x from x and its sine and cosine.
template <class T>
T sinc(const T& x, const math::SinCos<T>& sin_cos_x) {
  return sinc_derivatives(x, sin_cos_x).value;
}
template <int N, class T>
Dual<N, T> sinc(const Dual<N, T>& x, const math::SinCos<Dual<N, T>>& sin_cos_x) {
  const Derivatives<T> f = sinc_derivatives<T>(x.v, {sin_cos_x.sin.v, sin_cos_x.cos.v});
  return chain_rule(x, f.value, f.first);
}
template <class T>
Taylor2<T> sinc(const Taylor2<T>& x, const math::SinCos<Taylor2<T>>& sin_cos_x) {
  const Derivatives<T> f = sinc_derivatives<T>(x.v, {sin_cos_x.sin.v, sin_cos_x.cos.v});
  return chain_rule(x, f.value, f.first, f.second);
}

/// Returns atan(x) / x.
template <class T>
T atan_over(const T& x) {
  // The identity atan x = 2 atan(x / (1 + sqrt(1 + x^2))), used three times, reduces the argument below 0.2.
  // There, 13 terms of the power series give full precision.
  T y = x;
  T factor(1);
  for (int i = 0; i < 3; ++i) {
    const T shrink = T(1) / (math::sqrt(T(y * y + 1.0)) + 1.0);
    y = y * shrink;
    factor = factor * shrink * 2.0;
  }
  const T y2 = y * y;
  T series(0);
  for (int k = 12; k >= 0; --k) series = series * y2 * -1.0 + T(1.0 / (2 * k + 1));
  return factor * series;
}

}  // namespace pliant
