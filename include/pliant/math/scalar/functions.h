// The elementary functions of the engine's formulas. Formulas call math::sin(x) and so on, whatever the
// scalar (double, long double, Pack, Dual, Taylor2): the scalar's own overload is found beside its type.
#pragma once

#include <cmath>

#include <pliant/math/scalar/elementary.h>

namespace pliant {
inline constexpr double kPi = 3.14159265358979323846;

/// The plain number in a scalar, for decisions.
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

/// Sine and cosine of the same angle, at the price of one.
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
/// The root of x >= 0 whose slope at 0 is taken to be 0 (a length at its origin).
template <class T>
inline T sqrt_from_zero(const T& x) {
  const T inside = x - T(1e-300);
  return where_positive(inside, T(sqrt(where_positive(inside, x, T(1)))), T(0));
}

}  // namespace pliant::math
