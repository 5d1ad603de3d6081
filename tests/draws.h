// Pseudorandom numbers, parameter values and material points for tests. They are identical on every machine.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include <pliant/math/parameter_spec.h>
#include <pliant/math/scalar/functions.h>
#include <pliant/shape/shape.h>

namespace pliant::test {

class Draws {
 public:
  explicit Draws(std::uint64_t seed) : state_(seed * 0x9e3779b97f4a7c15u + 0x1234567u) {}

  /// Returns a number from `from` (included) to `to`.
  double uniform(double from, double to) {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return from + (to - from) * (static_cast<double>(state_ >> 11) * 0x1.0p-53);
  }
  /// Returns an integer from `from` to `to`, both included.
  int integer(int from, int to) {
    return std::min(to, static_cast<int>(uniform(from, static_cast<double>(to) + 1)));
  }
  /// Returns a vector with components between -size and size.
  Vec3<double> vector(double size) {
    return {uniform(-size, size), uniform(-size, size), uniform(-size, size)};
  }

  /// Returns a value of a parameter. If the dynamic range of the parameter is relative to its rest value, the
  /// result is 0.6 to 1.7 times the default. Otherwise the result is in the dynamic range and differs by at
  /// most 3 from the default.
  double parameter(const ParameterSpec& spec) {
    if (spec.relative) return spec.standard * uniform(0.6, 1.7);
    return uniform(std::max(spec.dynamic.min, spec.standard - 3),
                   std::min(spec.dynamic.max, spec.standard + 3));
  }

  /// Returns a material point of a shape with this mesh pattern, inside and never on the surface (w < 1).
  Material<double> material(MeshPattern pattern) {
    const double tall = pattern == MeshPattern::torus ? kPi : kPi / 2;
    return material_at(uniform(-tall, tall), uniform(-kPi, kPi), uniform(0, 1));
  }

 private:
  std::uint64_t state_;
};

/// Returns all material points (u, v, w) whose u and v are multiples of pi / 4, for w = 0, 0.5 and 1. They
/// include poles, seams and ends of quadrature panels.
inline std::vector<Material<double>> special_points(MeshPattern pattern) {
  std::vector<Material<double>> all;
  const int tall = pattern == MeshPattern::torus ? 4 : 2;
  for (int i = -tall; i <= tall; ++i)
    for (int j = -4; j < 4; ++j)
      for (double w : {0.0, 0.5, 1.0}) all.push_back(material_at(i * kPi / 4, j * kPi / 4, w));
  return all;
}

}  // namespace pliant::test
