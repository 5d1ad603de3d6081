// Pack: four doubles that move through a formula together, so that one evaluation serves four material
// points. Arithmetic maps onto the vector units of the target; results do not depend on their width.
#pragma once

#include <cmath>

#include <Eigen/Core>

#include <pliant/math/functions.h>

// The kernels are inlined; the note about passing wide vectors by value concerns calls that never happen.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace pliant {

// How a Pack is passed between functions depends on the target, so its name does: code compiled for different
// targets does not link instead of failing at run time.
#ifdef __AVX__
inline namespace avx {
#else
inline namespace baseline {
#endif

struct Pack {
  static constexpr int kLanes = 4;
  // No more aligned than Eigen aligns its arrays.
  using Vector [[gnu::vector_size(kLanes * sizeof(double)), gnu::aligned(16)]] = double;

  Vector lanes;

  Pack() = default;
  Pack(double all) : lanes{all, all, all, all} {}  // NOLINT(google-explicit-constructor): scalars broadcast
  explicit Pack(Vector v) : lanes(v) {}

  double operator[](int i) const { return lanes[i]; }
  void set(int i, double value) { lanes[i] = value; }

  Pack& operator+=(const Pack& o) {
    lanes += o.lanes;
    return *this;
  }
  Pack& operator-=(const Pack& o) {
    lanes -= o.lanes;
    return *this;
  }
  Pack& operator*=(const Pack& o) {
    lanes *= o.lanes;
    return *this;
  }
  Pack& operator/=(const Pack& o) {
    lanes /= o.lanes;
    return *this;
  }
  friend Pack operator+(Pack a, const Pack& b) { return a += b; }
  friend Pack operator-(Pack a, const Pack& b) { return a -= b; }
  friend Pack operator*(Pack a, const Pack& b) { return a *= b; }
  friend Pack operator/(Pack a, const Pack& b) { return a /= b; }
  friend Pack operator-(const Pack& a) { return Pack(-a.lanes); }

  /// The same number in all lanes, as the parameters of a formula are.
  bool uniform() const { return lanes[0] == lanes[1] && lanes[0] == lanes[2] && lanes[0] == lanes[3]; }

  /// A function of one double, lane by lane.
  template <class F>
  Pack map(F&& f) const {
    if (uniform()) return Pack(f(lanes[0]));
    Pack r;
    for (int i = 0; i < kLanes; ++i) r.lanes[i] = f(lanes[i]);
    return r;
  }
  friend Pack sin(const Pack& a) {
    return a.map([](double x) { return std::sin(x); });
  }
  friend Pack cos(const Pack& a) {
    return a.map([](double x) { return std::cos(x); });
  }
  friend math::SinCos<Pack> sin_cos_of(const Pack& a) {
    math::SinCos<Pack> r;
    if (a.uniform()) {
      const auto one = math::sin_cos(a.lanes[0]);
      return {Pack(one.sin), Pack(one.cos)};
    }
    for (int i = 0; i < kLanes; ++i) {
      const auto one = math::sin_cos(a.lanes[i]);
      r.sin.lanes[i] = one.sin;
      r.cos.lanes[i] = one.cos;
    }
    return r;
  }
  friend Pack exp(const Pack& a) {
    return a.map([](double x) { return std::exp(x); });
  }
  friend Pack log(const Pack& a) {
    return a.map([](double x) { return std::log(x); });
  }
  friend Pack sqrt(const Pack& a) {
    return a.map([](double x) { return std::sqrt(x); });
  }
  friend Pack select_positive(const Pack& c, const Pack& x, const Pack& y) {
    return Pack(c.lanes > 0 ? x.lanes : y.lanes);
  }

  /// Sum of the lanes, in a fixed order.
  friend double sum(const Pack& a) { return (a[0] + a[1]) + (a[2] + a[3]); }
};

}  // namespace

}  // namespace pliant

template <>
struct Eigen::NumTraits<pliant::Pack> : Eigen::NumTraits<double> {
  using Real = pliant::Pack;
  using NonInteger = pliant::Pack;
  using Nested = pliant::Pack;
};
