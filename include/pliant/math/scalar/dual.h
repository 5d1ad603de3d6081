// Dual numbers: x = v + sum_i d_i e_i with e_i e_j = 0. A formula evaluated on dual numbers returns its value
// and its N exact partial derivatives. T is double, Pack (four points at once), another Dual, or long double.
#pragma once

#include <array>
#include <type_traits>

#include <pliant/math/scalar/functions.h>
#include <pliant/math/scalar/pack.h>

namespace pliant {

/// A number with N partial derivatives over the scalar T.
template <int N, class T = double>
struct Dual {
  T v;                 ///< value
  std::array<T, N> d;  ///< partial derivatives

  /// Constants of a formula: all types that convert to T.
  template <class C>
  using IfConstant = std::enable_if_t<std::is_convertible_v<C, T> && !std::is_same_v<C, Dual>, int>;

  Dual() = default;
  template <class C, IfConstant<C> = 0>
  Dual(const C& value) : v(value), d{} {}  // NOLINT(google-explicit-constructor): constants convert silently

  /// Converts from a dual over a narrower scalar C (double to Pack) with N partials. If Dual<N, C> converts
  /// to T itself, the constructor above treats it as a constant.
  template <class C, std::enable_if_t<std::is_convertible_v<C, T> && !std::is_same_v<C, T> &&
                                          !std::is_convertible_v<Dual<N, C>, T>,
                                      int> = 0>
  explicit Dual(const Dual<N, C>& o) : v(o.v) {
    for (std::size_t i = 0; i < N; ++i) d[i] = T(o.d[i]);
  }

  /// Returns the independent variable number i at a value: its partial derivative i is 1, the others are 0.
  static Dual variable(const T& value, int i) {
    Dual x(value);
    x.d[static_cast<std::size_t>(i)] = T(1);
    return x;
  }

  Dual& operator+=(const Dual& o) {
    v += o.v;
    for (std::size_t i = 0; i < N; ++i) d[i] += o.d[i];
    return *this;
  }
  Dual& operator-=(const Dual& o) {
    v -= o.v;
    for (std::size_t i = 0; i < N; ++i) d[i] -= o.d[i];
    return *this;
  }
  Dual& operator*=(const Dual& o) { return *this = *this * o; }
  Dual& operator/=(const Dual& o) { return *this = *this / o; }

  friend Dual operator+(Dual a, const Dual& b) { return a += b; }
  friend Dual operator-(Dual a, const Dual& b) { return a -= b; }
  friend Dual operator-(Dual a) {
    a.v = -a.v;
    for (T& x : a.d) x = -x;
    return a;
  }
  friend Dual operator*(const Dual& a, const Dual& b) {
    Dual r;
    r.v = a.v * b.v;
    for (std::size_t i = 0; i < N; ++i) r.d[i] = a.d[i] * b.v + a.v * b.d[i];
    return r;
  }
  friend Dual operator/(const Dual& a, const Dual& b) {
    const T inverse = T(1) / b.v;
    Dual r;
    r.v = a.v / b.v;
    for (std::size_t i = 0; i < N; ++i) r.d[i] = (a.d[i] - r.v * b.d[i]) * inverse;
    return r;
  }

  // Operations with constants skip the products with zero derivatives.
  template <class C, IfConstant<C> = 0>
  friend Dual operator+(Dual a, const C& c) {
    a.v += T(c);
    return a;
  }
  template <class C, IfConstant<C> = 0>
  friend Dual operator+(const C& c, Dual a) {
    a.v += T(c);
    return a;
  }
  template <class C, IfConstant<C> = 0>
  friend Dual operator-(Dual a, const C& c) {
    a.v -= T(c);
    return a;
  }
  template <class C, IfConstant<C> = 0>
  friend Dual operator-(const C& c, const Dual& a) {
    return -a + c;
  }
  template <class C, IfConstant<C> = 0>
  friend Dual operator*(Dual a, const C& c) {
    const T factor(c);
    a.v *= factor;
    for (T& x : a.d) x *= factor;
    return a;
  }
  template <class C, IfConstant<C> = 0>
  friend Dual operator*(const C& c, Dual a) {
    return a * c;
  }
  template <class C, IfConstant<C> = 0>
  friend Dual operator/(Dual a, const C& c) {
    const T divisor(c);
    a.v /= divisor;
    for (T& x : a.d) x /= divisor;
    return a;
  }
  template <class C, IfConstant<C> = 0>
  friend Dual operator/(const C& c, const Dual& a) {
    return Dual(c) / a;
  }

  /// Returns f(a) from the value and the slope of f at a.v.
  friend Dual chain_rule(const Dual& a, const T& value, const T& slope) {
    Dual r;
    r.v = value;
    for (std::size_t i = 0; i < N; ++i) r.d[i] = slope * a.d[i];
    return r;
  }
  friend math::SinCos<Dual> sin_cos_of(const Dual& a) {
    const math::SinCos<T> r = math::sin_cos(a.v);
    return {chain_rule(a, r.sin, r.cos), chain_rule(a, r.cos, T(-r.sin))};
  }
  friend Dual sin(const Dual& a) { return sin_cos_of(a).sin; }
  friend Dual cos(const Dual& a) { return sin_cos_of(a).cos; }
  friend Dual exp(const Dual& a) {
    const T e = math::exp(a.v);
    return chain_rule(a, e, e);
  }
  friend Dual log(const Dual& a) { return chain_rule(a, math::log(a.v), T(T(1) / a.v)); }
  friend Dual sqrt(const Dual& a) {
    const T r = math::sqrt(a.v);
    return chain_rule(a, r, T(T(0.5) / r));
  }
  friend Dual acos(const Dual& a) {
    return chain_rule(a, math::acos(a.v), T(T(-1) / math::sqrt(T(T(1) - a.v * a.v))));
  }
  friend double plain(const Dual& a) { return plain(a.v); }
  friend Dual select_positive(const Dual& c, const Dual& x, const Dual& y) {
    Dual r;
    r.v = math::where_positive(c.v, x.v, y.v);
    for (std::size_t i = 0; i < N; ++i) r.d[i] = math::where_positive(c.v, x.d[i], y.d[i]);
    return r;
  }
};

/// Returns whether x equals the number c and all derivatives of x, if it has any, are zero.
inline bool is_constant(double x, double c) {
  return x == c;
}
template <int N>
bool is_constant(const Dual<N>& x, double c) {
  for (const double d : x.d)
    if (d != 0) return false;
  return x.v == c;
}

}  // namespace pliant

#ifndef PLIANT_DOXYGEN  // Doxygen does not know Eigen
template <int N, class T>
struct Eigen::NumTraits<pliant::Dual<N, T>> : Eigen::NumTraits<double> {
  using Real = pliant::Dual<N, T>;
  using NonInteger = pliant::Dual<N, T>;
  using Nested = pliant::Dual<N, T>;
  enum { RequireInitialization = 1 };
};
#endif
