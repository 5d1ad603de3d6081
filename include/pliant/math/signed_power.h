// Signed powers of a sine or cosine, C^eps = sgn(x) |x|^eps, the building block of the superquadrics (design 1.1).
// The logarithm of |x| is kept with x, so that a power costs one exponential, and 0^eps log 0 is 0, never NaN.
#pragma once

#include <pliant/math/functions.h>

namespace pliant {

/// A cosine or sine of a material angle with its sign and the logarithm of its size.
template <class U>
struct Trig {
  U x;         ///< the value, in [-1, 1], exact zeros at poles and seams
  U sign;      ///< -1, 0 or 1
  U log_abs;   ///< log |x|; kLogZero for x = 0

  /// Stands for log 0: finite, so that 0 * log 0 is 0, and exp(eps * kLogZero) is 0 for every eps in use.
  static constexpr double kLogZero = -1e6;

  /// sgn(x) |x|^eps. T is the scalar of the exponent.
  template <class T>
  T power(const T& eps) const {
    return math::exp(T(eps * log_abs)) * sign;
  }
};

inline Trig<double> trig(double x) {
  const double sign = x > 0 ? 1.0 : (x < 0 ? -1.0 : 0.0);
  return {x, sign, sign != 0 ? std::log(std::abs(x)) : Trig<double>::kLogZero};
}

}  // namespace pliant
