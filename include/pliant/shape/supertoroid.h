// Supertoroid (Barr 1981): a superellipse, the tube, that is swept along a second superellipse, the core
// ring. The angles are -pi <= u, v < pi, and w = 0 on the core ring:
//   e = (a1 (a4 + w C_u^eps1) C_v^eps2, a2 (a4 + w C_u^eps1) S_v^eps2, a3 w S_u^eps1)
#pragma once

#include <algorithm>
#include <cmath>

#include <pliant/shape/superellipsoid.h>

namespace pliant {

struct Supertoroid {
  static constexpr const char* name = "supertoroid";
  static constexpr const char* formula =
      "(a1 (a4 + w C_u^eps1) C_v^eps2, a2 (a4 + w C_u^eps1) S_v^eps2, a3 w S_u^eps1)";
  static constexpr std::array<ParameterSpec, 6> parameters{{
      length("a1", 0.25, "semi-axis of the tube along x"),
      length("a2", 0.25, "semi-axis of the tube along y"),
      length("a3", 0.25, "semi-axis of the tube along z"),
      ratio("a4", 3, {1, 1e6}, {1, 1e6}, "radius of the core ring in units of a1, a2", Follows::ring),
      exponent("eps1", "squareness of the tube", Follows::ring),
      exponent("eps2", "squareness of the ring", Follows::free),
  }};
  static constexpr MeshPattern mesh = MeshPattern::torus;
  static constexpr bool linear_lengths = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 6>& a) {
    const T ring = signed_power(m.cu, a[4]) * m.w + a[3];
    return {a[0] * ring * signed_power(m.cv, a[5]), a[1] * ring * signed_power(m.sv, a[5]),
            a[2] * signed_power(m.su, a[4]) * m.w};
  }
  template <class T>
  static T half_height(const Vec<T, 6>& a) {
    return a[2];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 6>& a) {
    const T ring = power_norm(T(math::abs(x[0]) / a[0]), T(math::abs(x[1]) / a[1]), T(T(2) / a[5]));
    return power_norm(T(math::abs(T(ring - a[3]))), T(math::abs(x[2]) / a[2]), T(T(2) / a[4]));
  }
  /// Piece 0 is the hull of the whole solid. Pieces 1 to 4 are the sections of the tube on the diagonals of
  /// the four quadrants of (x, y). With these pieces, contact finds several points of a torus that rests flat
  /// on a plane.
  static constexpr int hull_pieces = 5;
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 6>& a, int piece) {
    const T along_z = math::abs(m[2]) * a[2];
    if (piece == 0) {
      const auto ring = superellipse_support(T(math::abs(m[0]) * a[0]), T(math::abs(m[1]) * a[1]), a[5]);
      const auto tube = superellipse_support(ring.h, along_z, a[4]);
      const T width = tube.x + a[3];
      return {a[0] * width * ring.x * sign_factor(m[0]), a[1] * width * ring.y * sign_factor(m[1]),
              a[2] * tube.y * sign_factor(m[2])};
    }
    // The section in the direction (+-1, +-1) of the unit superellipse.
    const T diagonal = math::exp(T(a[5] * -0.5 * std::log(2.0)));
    const double x = piece == 1 || piece == 4 ? 1 : -1, y = piece < 3 ? 1 : -1;
    const T outward = diagonal * (a[0] * m[0] * x + a[1] * m[1] * y);
    const auto tube = superellipse_support(T(math::abs(outward)), along_z, a[4]);
    const T width = (tube.x * sign_factor(outward) + a[3]) * diagonal;
    return {a[0] * width * x, a[1] * width * y, a[2] * tube.y * sign_factor(m[2])};
  }
  /// Returns whether both the tube and the ring are round. Other supertoroids touch a plane with a face or an
  /// edge.
  static bool has_support(const Vec<double, 6>& a) {
    return std::min(a[4], a[5]) >= kMinRoundExponent && std::max(a[4], a[5]) <= kMaxRoundExponent;
  }
  static bool has_flat_regions(const Vec<double, 6>&) { return false; }
  static bool is_convex(const Vec<double, 6>&) { return false; }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 6>& a);
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 6>& a);
  static std::vector<Panel> profile(const Vec<double, 6>& a, bool dynamic_exponents);
  /// Returns the exponent of the superellipse that a ring (u, w) = const follows.
  static double ring_exponent(const Vec<double, 6>& a) { return a[5]; }
  static std::vector<Panel> ring(const Vec<double, 6>& a, bool dynamic_exponents);
  static Section section(double zeta, double gap, const Vec<double, 6>& a);
  static std::vector<SectionPanel> section_panels(const Vec<double, 6>& a);
};

inline Material<double> Supertoroid::label(const Vec3<double>& x, const Vec<double, 6>& a) {
  const double ring = power_norm<double>(std::abs(x[0] / a[0]), std::abs(x[1] / a[1]), 2 / a[5]);
  const auto [cv, sv] = superellipse_label(x[0] / a[0], x[1] / a[1], a[5]);
  const auto [cu, su] = superellipse_label(ring - a[3], x[2] / a[2], a[4]);
  return {cu, su, cv, sv, gauge<double>(x, a)};
}
inline Material<double> Supertoroid::mesh_label(const Vec3<double>& g, const Vec<double, 6>& a) {
  const auto [cv, sv] = superellipse_label(std::cos(g[1]), std::sin(g[1]), a[5]);
  const auto [cu, su] = superellipse_label(std::cos(g[0]), std::sin(g[0]), a[4]);
  return {cu, su, cv, sv, 1.0};
}
inline std::vector<Panel> Supertoroid::profile(const Vec<double, 6>& a, bool dynamic_exponents) {
  return circle_panels(a[4], dynamic_exponents);
}
inline std::vector<Panel> Supertoroid::ring(const Vec<double, 6>& a, bool dynamic_exponents) {
  return circle_panels(a[5], dynamic_exponents);
}
inline Section Supertoroid::section(double zeta, double gap, const Vec<double, 6>& a) {
  const double q = superellipse_width(zeta, gap, a[4]), inner = a[3] - q, outer = a[3] + q;
  const Section unit = superellipse_section(a[5]);
  // The section is the region between two similar superellipses. In units of the unit superellipse, its area
  // is outer^2 - inner^2 = 4 a4 q, and its mean squares are outer^2 + inner^2.
  const double area = 4 * a[3] * q, spread = inner * inner + outer * outer;
  return {unit.area * a[0] * a[1] * area, unit.xx * a[0] * a[0] * spread, unit.yy * a[1] * a[1] * spread};
}
inline std::vector<SectionPanel> Supertoroid::section_panels(const Vec<double, 6>&) {
  return {{-1, 0, true}, {0, 1, true}};
}

}  // namespace pliant
