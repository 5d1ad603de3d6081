// Shear along x and y: (x + sx h zeta, y + sy h zeta, z), with h zeta = z.
#pragma once

#include <pliant/deform/deform.h>

namespace pliant {

struct Shear {
  static constexpr const char* name = "shear";
  static constexpr const char* formula = "(x + sx h zeta, y + sy h zeta, z)";
  static constexpr std::array<ParameterSpec, 2> parameters{{
      ratio("sx", 0, {-1e3, 1e3}, {-10, 10}, "slope of the axis towards x", Follows::affine),
      ratio("sy", 0, {-1e3, 1e3}, {-10, 10}, "slope of the axis towards y", Follows::affine),
  }};
  static constexpr Sections sections = Sections::stay_affine;

  template <class T>
  static Vec3<T> apply(const Vec3<T>& p, const T&, const Vec<T, 2>& b) {
    return {p[0] + b[0] * p[2], p[1] + b[1] * p[2], p[2]};
  }
  template <class T>
  static Vec3<T> inverse(const Vec3<T>& p, const T&, const Vec<T, 2>& b) {
    return {p[0] - b[0] * p[2], p[1] - b[1] * p[2], p[2]};
  }
};

}  // namespace pliant
