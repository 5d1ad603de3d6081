// The elementary functions of the engine's formulas. Formulas call math::sin(x) and so on, whatever the
// scalar (double, long double, Pack, Dual, Taylor2): the scalar's own overload is found beside its type.
#pragma once

#include <cmath>

namespace pliant {
inline constexpr double kPi = 3.14159265358979323846;
}  // namespace pliant

namespace pliant::math {

// A reproducible kernel can stand in for the C library here.
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
#undef PLIANT_MATH_FUNCTION

/// Sine and cosine of the same angle, at little more than the price of one.
template <class T>
struct SinCos {
  T sin, cos;
};
inline SinCos<double> sin_cos_of(double x) {
  return {std::sin(x), std::cos(x)};
}
inline SinCos<long double> sin_cos_of(long double x) {
  return {std::sin(x), std::cos(x)};
}
template <class T>
inline SinCos<T> sin_cos(const T& x) {
  return sin_cos_of(x);
}

/// x where c > 0, else y; for a pack lane by lane, for a derivative number along the branch taken.
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
