// Twist (Barr 1984): each section z = const is rotated about z by angle * zeta, zeta = z / h.
#pragma once

#include <pliant/deform/deform.h>

namespace pliant {

struct Twist {
  static constexpr const char* name = "twist";
  static constexpr const char* formula = "(x cos t - y sin t, x sin t + y cos t, z), t = angle zeta";
  static constexpr std::array<ParameterSpec, 1> parameters{{
      angle("angle", {-700, 700}, {-6.3, 6.3}, "turn of the section at zeta = 1", Follows::section),
  }};
  static constexpr Sections sections = Sections::stay_plane;

  template <class T>
  static Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, 1>& b) {
    const auto [s, c] = math::sin_cos(T(b[0] * p[2] / h));
    return {c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]};
  }
  template <class T>
  static Vec3<T> inverse(const Vec3<T>& p, const T& h, const Vec<T, 1>& b) {
    return apply<T>(p, h, Vec<T, 1>(-b[0]));
  }
};

}  // namespace pliant
