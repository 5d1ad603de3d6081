// The place where a function of one variable changes its sign.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

namespace pliant {

/// Returns x between low and high where f changes its sign from negative to positive, within `accuracy` or
/// rounding; low if f(low) >= 0, and otherwise high if f(high) <= 0. The function need not be continuous.
/// The method of Chandrupatla (1997) alternates inverse quadratic interpolation and bisection.
template <class F>
double sign_change(double low, double high, double accuracy, const F& f) {
  double a = low, b = high, f_a = f(a);
  if (!(f_a < 0)) return low;
  double f_b = f(b);
  if (!(f_b > 0)) return high;
  double share = 0.5;  // of the next point on the way from a to b
  for (;;) {
    double c = a, f_c = f_a;
    const double x = a + share * (b - a), f_x = f(x);
    if ((f_x > 0) != (f_a > 0)) {
      c = b;
      f_c = f_b;
      b = a;
      f_b = f_a;
    }
    a = x;
    f_a = f_x;
    const double best = std::abs(f_a) < std::abs(f_b) ? a : b,
                 tolerance = 2 * std::numeric_limits<double>::epsilon() * std::abs(best) + accuracy,
                 least_share = tolerance / std::abs(b - a);
    if (f_x == 0) return x;
    if (!(least_share < 0.5)) return best;
    const double xi = (a - b) / (c - b), phi = (f_a - f_b) / (f_c - f_b);
    const bool interpolate = phi * phi < xi && (1 - phi) * (1 - phi) < 1 - xi;
    share = interpolate ? f_a / (f_b - f_a) * f_c / (f_b - f_c) +
                              (c - a) / (b - a) * f_a / (f_c - f_a) * f_b / (f_c - f_b)
                        : 0.5;
    share = std::clamp(share, least_share, 1 - least_share);
  }
}

}  // namespace pliant
