// Truncated second-order Taylor numbers in one variable t: value v, first derivative d, second derivative dd.
// A formula s evaluated at q + t qdot returns, at t = 0, the exact s, J qdot and Jdot qdot. The inertial
// forces g_q of Eq. (11) contain Jdot qdot.
#pragma once

#include <type_traits>

#include <pliant/math/scalar/functions.h>
#include <pliant/math/scalar/pack.h>

namespace pliant {

/// A number with its first and second derivative in one variable, over the scalar T.
template <class T = double>
struct Taylor2 {
  T v, d, dd;

  template <class C>
  using IfConstant = std::enable_if_t<std::is_convertible_v<C, T> && !std::is_same_v<C, Taylor2>, int>;

  Taylor2() = default;
  template <class C, IfConstant<C> = 0>
  Taylor2(const C& value) : v(value), d(0.0), dd(0.0) {}  // NOLINT(google-explicit-constructor): constants
  Taylor2(const T& value, const T& first, const T& second) : v(value), d(first), dd(second) {}

  Taylor2& operator+=(const Taylor2& o) { return *this = *this + o; }
  Taylor2& operator-=(const Taylor2& o) { return *this = *this - o; }
  Taylor2& operator*=(const Taylor2& o) { return *this = *this * o; }
  Taylor2& operator/=(const Taylor2& o) { return *this = *this / o; }

  friend Taylor2 operator+(const Taylor2& a, const Taylor2& b) { return {a.v + b.v, a.d + b.d, a.dd + b.dd}; }
  friend Taylor2 operator-(const Taylor2& a, const Taylor2& b) { return {a.v - b.v, a.d - b.d, a.dd - b.dd}; }
  friend Taylor2 operator-(const Taylor2& a) { return {-a.v, -a.d, -a.dd}; }
  friend Taylor2 operator*(const Taylor2& a, const Taylor2& b) {
    return {a.v * b.v, a.d * b.v + a.v * b.d, a.dd * b.v + a.d * b.d * 2.0 + a.v * b.dd};
  }
  friend Taylor2 operator/(const Taylor2& a, const Taylor2& b) {
    const T value = a.v / b.v;
    const T first = (a.d - value * b.d) / b.v;
    return {value, first, (a.dd - first * b.d * 2.0 - value * b.dd) / b.v};
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator+(const Taylor2& a, const C& c) {
    return {a.v + T(c), a.d, a.dd};
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator+(const C& c, const Taylor2& a) {
    return a + c;
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator-(const Taylor2& a, const C& c) {
    return {a.v - T(c), a.d, a.dd};
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator-(const C& c, const Taylor2& a) {
    return {T(c) - a.v, -a.d, -a.dd};
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator*(const Taylor2& a, const C& c) {
    const T factor(c);
    return {a.v * factor, a.d * factor, a.dd * factor};
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator*(const C& c, const Taylor2& a) {
    return a * c;
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator/(const Taylor2& a, const C& c) {
    const T divisor(c);
    return {a.v / divisor, a.d / divisor, a.dd / divisor};
  }
  template <class C, IfConstant<C> = 0>
  friend Taylor2 operator/(const C& c, const Taylor2& a) {
    return Taylor2(c) / a;
  }

  /// Returns f(a) from the value and the first and second derivative (slope, curvature) of f at a.v.
  friend Taylor2 chain_rule(const Taylor2& a, const T& value, const T& slope, const T& curvature) {
    return {value, slope * a.d, curvature * a.d * a.d + slope * a.dd};
  }
  friend Taylor2 acos(const Taylor2& a) {
    const T sine2 = T(1.0) - a.v * a.v, slope = T(-1.0) / math::sqrt(sine2);
    return chain_rule(a, math::acos(a.v), slope, T(slope * a.v / sine2));
  }
  friend double plain(const Taylor2& a) { return plain(a.v); }
  friend math::SinCos<Taylor2> sin_cos_of(const Taylor2& a) {
    const math::SinCos<T> r = math::sin_cos(a.v);
    return {chain_rule(a, r.sin, r.cos, T(-r.sin)), chain_rule(a, r.cos, T(-r.sin), T(-r.cos))};
  }
  friend Taylor2 sin(const Taylor2& a) { return sin_cos_of(a).sin; }
  friend Taylor2 cos(const Taylor2& a) { return sin_cos_of(a).cos; }
  friend Taylor2 exp(const Taylor2& a) {
    const T e = math::exp(a.v);
    return chain_rule(a, e, e, e);
  }
  friend Taylor2 log(const Taylor2& a) {
    const T slope = T(1) / a.v;
    return chain_rule(a, math::log(a.v), slope, T(-slope * slope));
  }
  friend Taylor2 sqrt(const Taylor2& a) {
    const T r = math::sqrt(a.v);
    const T slope = T(0.5) / r;
    return chain_rule(a, r, slope, T(slope * T(-0.5) / a.v));
  }
  friend Taylor2 select_positive(const Taylor2& c, const Taylor2& x, const Taylor2& y) {
    return {math::where_positive(c.v, x.v, y.v), math::where_positive(c.v, x.d, y.d),
            math::where_positive(c.v, x.dd, y.dd)};
  }
};

}  // namespace pliant

#ifndef PLIANT_DOXYGEN  // Doxygen does not know Eigen
template <class T>
struct Eigen::NumTraits<pliant::Taylor2<T>> : Eigen::NumTraits<double> {
  using Real = pliant::Taylor2<T>;
  using NonInteger = pliant::Taylor2<T>;
  using Nested = pliant::Taylor2<T>;
  enum { RequireInitialization = 1 };
};
#endif
