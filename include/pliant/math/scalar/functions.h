// The elementary functions of the engine's formulas. A formula calls math::sin(x) for every scalar (double,
// long double, Pack, Dual, Taylor2); argument-dependent lookup finds the overload of the scalar.
#pragma once

#include <cmath>

#include <pliant/math/scalar/elementary.h>

namespace pliant {
inline constexpr double kPi = 3.14159265358979323846;

/// Returns the value of a scalar without its derivatives, for comparisons.
inline double plain(double x) {
  return x;
}
inline double plain(long double x) {
  return static_cast<double>(x);
}
}  // namespace pliant

namespace pliant::math {

#define PLIANT_MATH_FUNCTION(f) \
  template <class T>            \
  inline T f(const T& x) {      \
    using std::f;               \
    return f(x);                \
  }
PLIANT_MATH_FUNCTION(sin)
PLIANT_MATH_FUNCTION(cos)
PLIANT_MATH_FUNCTION(exp)
PLIANT_MATH_FUNCTION(log)
PLIANT_MATH_FUNCTION(sqrt)
PLIANT_MATH_FUNCTION(acos)
#undef PLIANT_MATH_FUNCTION

inline double exp(double x) {
  return elementary::exp(x);
}

/// Sine and cosine of one angle.
template <class T>
struct SinCos {
  T sin, cos;
};
inline SinCos<double> sin_cos_of(double x) {
  SinCos<double> r;
  if (!(std::abs(x) <= elementary::kLargestAngle)) return {std::sin(x), std::cos(x)};
  elementary::sin_cos(x, r.sin, r.cos);
  return r;
}
inline SinCos<long double> sin_cos_of(long double x) {
  return {std::sin(x), std::cos(x)};
}
/// Returns sine and cosine of x (rad); both together cost about as much as one.
template <class T>
inline SinCos<T> sin_cos(const T& x) {
  return sin_cos_of(x);
}
inline double sin(double x) {
  return sin_cos_of(x).sin;
}
inline double cos(double x) {
  return sin_cos_of(x).cos;
}

template <class T>
inline T max(const T& x, const T& y) {
  return where_positive(T(x - y), x, y);
}
template <class T>
inline T min(const T& x, const T& y) {
  return where_positive(T(x - y), y, x);
}
template <class T>
inline T square(const T& x) {
  return x * x;
}
/// Returns the square root of x >= 0. Value and derivatives are 0 for x <= 1e-300, for example for the length
/// of a zero vector.
template <class T>
inline T sqrt_from_zero(const T& x) {
  const T inside = x - T(1e-300);
  return where_positive(inside, T(sqrt(where_positive(inside, x, T(1)))), T(0));
}

}  // namespace pliant::math
