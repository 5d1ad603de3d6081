// Superellipsoid (Barr 1981), the paper's shape, with the trigonometric material map, -pi/2 <= u <= pi/2:
//   e = w (a1 C_u^eps1 C_v^eps2, a2 C_u^eps1 S_v^eps2, a3 S_u^eps1)
//   gauge = ((|x/a1|^(2/eps2) + |y/a2|^(2/eps2))^(eps2/eps1) + |z/a3|^(2/eps1))^(eps1/2)
#pragma once

#include <algorithm>
#include <cmath>

#include <pliant/shape/shape.h>
#include <pliant/shape/superellipse.h>

namespace pliant {

/// A superellipsoid has nearly flat faces if one of its exponents is less than kMinRoundExponent. Above
/// kMaxRoundExponent it has nearly flat faces between its tips, and its support function is not used.
inline constexpr double kMinRoundExponent = 0.6, kMaxRoundExponent = 1.9;

struct Superellipsoid {
  static constexpr const char* name = "superellipsoid";
  static constexpr const char* formula = "w (a1 C_u^eps1 C_v^eps2, a2 C_u^eps1 S_v^eps2, a3 S_u^eps1)";
  static constexpr std::array<ParameterSpec, 5> parameters{{
      length("a1", 1, "semi-axis along x"),
      length("a2", 1, "semi-axis along y"),
      length("a3", 1, "semi-axis along z"),
      exponent("eps1", "squareness along z: 1 round, 0.1 square, 2 pointed", Follows::ring),
      exponent("eps2", "squareness in the x-y plane: 1 round, 0.1 square, 2 pointed", Follows::free),
  }};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 5>& a) {
    const T ring = signed_power(m.cu, a[3]) * m.w;
    return {a[0] * ring * signed_power(m.cv, a[4]), a[1] * ring * signed_power(m.sv, a[4]),
            a[2] * signed_power(m.su, a[3]) * m.w};
  }
  template <class T>
  static T half_height(const Vec<T, 5>& a) {
    return a[2];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 5>& a) {
    const T ring = power_norm(T(math::abs(x[0]) / a[0]), T(math::abs(x[1]) / a[1]), T(T(2) / a[4]));
    return power_norm(ring, T(math::abs(x[2]) / a[2]), T(T(2) / a[3]));
  }
  static constexpr int hull_pieces = 1;
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 5>& a, int) {
    const auto ring = superellipse_support(T(math::abs(m[0]) * a[0]), T(math::abs(m[1]) * a[1]), a[4]);
    const auto profile = superellipse_support(ring.h, T(math::abs(m[2]) * a[2]), a[3]);
    return {a[0] * profile.x * ring.x * sign_factor(m[0]), a[1] * profile.x * ring.y * sign_factor(m[1]),
            a[2] * profile.y * sign_factor(m[2])};
  }
  static bool has_support(const Vec<double, 5>& a) { return std::max(a[3], a[4]) <= kMaxRoundExponent; }
  static bool has_flat_regions(const Vec<double, 5>& a) { return std::min(a[3], a[4]) < kMinRoundExponent; }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 5>& a);
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 5>& a);
  static std::vector<Panel> profile(const Vec<double, 5>& a, bool dynamic_exponents);
  /// Returns the exponent of the superellipse that a ring (u, w) = const follows.
  static double ring_exponent(const Vec<double, 5>& a) { return a[4]; }
  static std::vector<Panel> ring(const Vec<double, 5>& a, bool dynamic_exponents);
  static Section section(double zeta, double gap, const Vec<double, 5>& a);
  static std::vector<SectionPanel> section_panels(const Vec<double, 5>& a);
};

inline Material<double> Superellipsoid::label(const Vec3<double>& x, const Vec<double, 5>& a) {
  const Vec3<double> unit{x[0] / a[0], x[1] / a[1], x[2] / a[2]};
  const double ring = power_norm<double>(std::abs(unit[0]), std::abs(unit[1]), 2 / a[4]);
  const auto [cv, sv] = superellipse_label(unit[0], unit[1], a[4]);
  if (ring == 0 && unit[2] == 0) return material_from(0, 1, 1, 0, 0);
  const auto [cu, su] = superellipse_label(ring, unit[2], a[3]);
  return {cu, su, cv, sv, gauge<double>(x, a)};
}

inline Material<double> Superellipsoid::mesh_label(const Vec3<double>& g, const Vec<double, 5>& a) {
  const auto [cv, sv] = superellipse_label(g[0], g[1], a[4]);
  const auto [cu, su] = superellipse_label(std::hypot(g[0], g[1]), g[2], a[3]);
  return {cu, su, cv, sv, 1.0};
}

inline std::vector<Panel> Superellipsoid::profile(const Vec<double, 5>& a, bool dynamic_exponents) {
  return half_circle_panels(a[3], dynamic_exponents);
}
inline std::vector<Panel> Superellipsoid::ring(const Vec<double, 5>& a, bool dynamic_exponents) {
  return circle_panels(a[4], dynamic_exponents);
}

inline Section Superellipsoid::section(double zeta, double gap, const Vec<double, 5>& a) {
  const double width = superellipse_width(zeta, gap, a[3]), width2 = width * width;
  const Section unit = superellipse_section(a[4]);
  return {unit.area * a[0] * a[1] * width2, unit.xx * a[0] * a[0] * width2, unit.yy * a[1] * a[1] * width2};
}
inline std::vector<SectionPanel> Superellipsoid::section_panels(const Vec<double, 5>& a) {
  return superellipse_section_panels(a[3]);
}

}  // namespace pliant
