// A scalar type that counts its additions, subtractions, multiplications, divisions and square roots.
#pragma once

#include <cmath>

#include <Eigen/Core>

namespace pliant::bench {

struct Counted {
  double value = 0;
  static inline long operations = 0;

  Counted() = default;
  Counted(double v) : value(v) {}  // NOLINT(google-explicit-constructor): formulas contain numbers
  static Counted counted(double v) {
    ++operations;
    return v;
  }
  friend Counted operator+(const Counted& a, const Counted& b) { return counted(a.value + b.value); }
  friend Counted operator-(const Counted& a, const Counted& b) { return counted(a.value - b.value); }
  friend Counted operator*(const Counted& a, const Counted& b) { return counted(a.value * b.value); }
  friend Counted operator/(const Counted& a, const Counted& b) { return counted(a.value / b.value); }
  friend Counted operator-(const Counted& a) { return -a.value; }
  Counted& operator+=(const Counted& b) { return *this = *this + b; }
  Counted& operator-=(const Counted& b) { return *this = *this - b; }
  friend Counted sqrt(const Counted& a) { return counted(std::sqrt(a.value)); }
  friend double min_lane(const Counted& a) { return a.value; }
};

}  // namespace pliant::bench

template <>
struct Eigen::NumTraits<pliant::bench::Counted> : Eigen::NumTraits<double> {
  using Real = pliant::bench::Counted;
  using NonInteger = pliant::bench::Counted;
  using Nested = pliant::bench::Counted;
};
