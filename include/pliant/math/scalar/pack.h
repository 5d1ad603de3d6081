// Pack: four doubles that a formula evaluates together, for four material points or four rigid parts at once.
// The arithmetic uses the vector units of the target; results do not depend on the width of these units.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include <Eigen/Core>

#include <pliant/math/scalar/functions.h>

// GCC reports that the ABI of wide vectors passed by value has changed. The change has no effect here,
// because all functions with vector arguments are inlined.
#if defined(__GNUC__) && !defined(__clang__)
#pragma GCC diagnostic ignored "-Wpsabi"
#endif

namespace pliant {

// The calling convention of a Pack depends on the target, and so does its namespace. Object files for
// different targets therefore fail to link, instead of failing at run time.
#ifdef __AVX__
inline namespace avx {
#else
inline namespace baseline {
#endif

/// Four doubles; all operations act lane by lane.
struct Pack {
  static constexpr int kLanes = 4;
  // Vectors have the width of a register, because compilers split comparisons of wider vectors into scalars.
#ifdef __AVX__
  static constexpr int kWidth = 4;
#else
  static constexpr int kWidth = 2;
#endif
  // The alignment is that of Eigen's arrays: the build sets EIGEN_MAX_STATIC_ALIGN_BYTES to 16.
  using Vector [[gnu::vector_size(kWidth * sizeof(double)), gnu::aligned(16)]] = double;
  using Bits [[gnu::vector_size(kWidth * sizeof(double)), gnu::aligned(16)]] = std::uint64_t;
  static constexpr int kVectors = kLanes / kWidth;

  Vector vectors[kVectors];

  Pack() = default;
  Pack(double all) {                               // NOLINT(google-explicit-constructor): scalars broadcast
    for (Vector& v : vectors) v = all - Vector{};  // subtracting 0 keeps the sign of a zero
  }

  Pack(double a, double b, double c, double d) {
#ifdef __AVX__
    vectors[0] = Vector{a, b, c, d};
#else
    vectors[0] = Vector{a, b};
    vectors[1] = Vector{c, d};
#endif
  }

  double operator[](int i) const {
    return vectors[i / kWidth][i % kWidth];
  }
  void set(int i, double value) {
    vectors[i / kWidth][i % kWidth] = value;
  }

  Pack& operator+=(const Pack& o) {
    for (int k = 0; k < kVectors; ++k) vectors[k] += o.vectors[k];
    return *this;
  }
  Pack& operator-=(const Pack& o) {
    for (int k = 0; k < kVectors; ++k) vectors[k] -= o.vectors[k];
    return *this;
  }
  Pack& operator*=(const Pack& o) {
    for (int k = 0; k < kVectors; ++k) vectors[k] *= o.vectors[k];
    return *this;
  }
  Pack& operator/=(const Pack& o) {
    for (int k = 0; k < kVectors; ++k) vectors[k] /= o.vectors[k];
    return *this;
  }
  friend Pack operator+(Pack a, const Pack& b) {
    return a += b;
  }
  friend Pack operator-(Pack a, const Pack& b) {
    return a -= b;
  }
  friend Pack operator*(Pack a, const Pack& b) {
    return a *= b;
  }
  friend Pack operator/(Pack a, const Pack& b) {
    return a /= b;
  }
  friend Pack operator-(Pack a) {
    for (Vector& v : a.vectors) v = -v;
    return a;
  }

  /// Applies a function of one double to each lane.
  template <class F>
  Pack map(F&& f) const {
    Pack r;
    for (int i = 0; i < kLanes; ++i) r.set(i, f((*this)[i]));
    return r;
  }
  friend math::SinCos<Pack> sin_cos_of(const Pack& a) {
    math::SinCos<Pack> r;
    if (a.within(math::elementary::kLargestAngle)) {
      math::elementary::sin_cos(a, r.sin, r.cos);
      return r;
    }
    return {a.map([](double x) { return math::sin(x); }), a.map([](double x) { return math::cos(x); })};
  }
  friend Pack sin(const Pack& a) {
    return sin_cos_of(a).sin;
  }
  friend Pack cos(const Pack& a) {
    return sin_cos_of(a).cos;
  }
  /// Returns 2^n for integers -1023 < n < 1024.
  friend Pack power_of_two(const Pack& n) {
    Pack power;
    for (int k = 0; k < kVectors; ++k) {
      const Vector shifted = n.vectors[k] + math::elementary::kRounder;
      Bits bits;
      std::memcpy(&bits, &shifted, sizeof bits);
      bits = (bits + 1023) << 52;
      std::memcpy(&power.vectors[k], &bits, sizeof bits);
    }
    return power;
  }
  friend Pack exp(const Pack& a) {
    return math::elementary::exp(a);
  }
  friend Pack log(const Pack& a) {
    return a.map([](double x) { return std::log(x); });
  }
  friend Pack sqrt(const Pack& a) {
    return a.map([](double x) { return std::sqrt(x); });
  }
  friend Pack select_positive(const Pack& c, const Pack& x, const Pack& y) {
    Pack r;
    for (int k = 0; k < kVectors; ++k) r.vectors[k] = c.vectors[k] > 0 ? x.vectors[k] : y.vectors[k];
    return r;
  }

  /// Returns the sum of the lanes, in a fixed order.
  friend double sum(const Pack& a) {
    return (a[0] + a[1]) + (a[2] + a[3]);
  }

 private:
  bool within(double most) const {
    for (int i = 0; i < kLanes; ++i)
      if (!(std::abs((*this)[i]) <= most)) return false;
    return true;
  }
};

}  // namespace

}  // namespace pliant

#ifndef PLIANT_DOXYGEN  // Doxygen does not know Eigen
template <>
struct Eigen::NumTraits<pliant::Pack> : Eigen::NumTraits<double> {
  using Real = pliant::Pack;
  using NonInteger = pliant::Pack;
  using Nested = pliant::Pack;
};
#endif
