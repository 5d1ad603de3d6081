// sin(x)/x and atan(x)/x with all derivatives finite and exact to rounding at x = 0: a power series near 0,
// the quotient elsewhere.
#pragma once

#include <pliant/math/functions.h>

namespace pliant {

/// sin(x) / x, with the sine at hand.
template <class T>
T sinc(const T& x, const T& sin_x) {
  const T x2 = x * x;
  T series(1);
  for (int k = 10; k >= 1; --k) series = series * x2 * (-1.0 / (2 * k * (2 * k + 1))) + 1.0;
  const T far = x2 - T(1.0);
  const T safe = math::where_positive(far, x, T(1));
  return math::where_positive(far, T(sin_x / safe), series);
}
template <class T>
T sinc(const T& x) {
  return sinc(x, T(math::sin(x)));
}

/// atan(x) / x.
template <class T>
T atan_over(const T& x) {
  // Three halvings, atan x = 2 atan(x / (1 + sqrt(1 + x^2))), bring the argument below 0.2; the series does
  // the rest.
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
