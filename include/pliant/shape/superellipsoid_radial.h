// Superellipsoid with the radial material map: the material point is a direction n = (C_u C_v, C_u S_v, S_u),
// and
//   e = diag(a1, a2, a3) w n / gauge_1(n; eps1, eps2),   gauge_1: the gauge for unit axes.
// The surface equals that of Superellipsoid. With the radial map, a changing exponent strains the material by
// bounded amounts only; with the trigonometric map of Superellipsoid the strains are unbounded (README.md).
#pragma once

#include <pliant/shape/superellipsoid.h>

namespace pliant {

struct SuperellipsoidRadial {
  static constexpr const char* name = "superellipsoid_radial";
  static constexpr const char* formula =
      "diag(a1, a2, a3) w n / gauge_1(n; eps1, eps2), n = (C_u C_v, C_u S_v, S_u)";
  static constexpr std::array<ParameterSpec, 5> parameters{{
      length("a1", 1, "semi-axis along x"),
      length("a2", 1, "semi-axis along y"),
      length("a3", 1, "semi-axis along z"),
      exponent("eps1", "squareness along z: 1 round, 0.1 square, 2 pointed", Follows::free),
      exponent("eps2", "squareness in the x-y plane: 1 round, 0.1 square, 2 pointed", Follows::free),
  }};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;
  static constexpr bool bounded_exponents = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 5>& a) {
    const Vec3<U> n{m.cu.x * m.cv.x, m.cu.x * m.sv.x, m.su.x};
    const Vec3<T> unit{T(math::abs(n[0])), T(math::abs(n[1])), T(math::abs(n[2]))};
    const T ring = power_norm(unit[0], unit[1], T(T(2) / a[4]));
    const T rho = T(T(1) / power_norm(ring, unit[2], T(T(2) / a[3]))) * m.w;
    return {a[0] * rho * n[0], a[1] * rho * n[1], a[2] * rho * n[2]};
  }
  template <class T>
  static T half_height(const Vec<T, 5>& a) {
    return a[2];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 5>& a) {
    return Superellipsoid::gauge(x, a);
  }
  static constexpr int hull_pieces = 1;
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 5>& a, int piece) {
    return Superellipsoid::support(m, a, piece);
  }
  static bool has_support(const Vec<double, 5>& a) { return Superellipsoid::has_support(a); }
  static bool has_flat_regions(const Vec<double, 5>& a) { return Superellipsoid::has_flat_regions(a); }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 5>& a);
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 5>& a);
  /// The trigonometric map generates the quadrature points, because the sharp edges of the surface are
  /// coordinate lines of this map.
  using RestMap = Superellipsoid;
  static Section section(double zeta, double gap, const Vec<double, 5>& a) {
    return Superellipsoid::section(zeta, gap, a);
  }
  static std::vector<SectionPanel> section_panels(const Vec<double, 5>& a) {
    return Superellipsoid::section_panels(a);
  }
};

inline Material<double> SuperellipsoidRadial::label(const Vec3<double>& x, const Vec<double, 5>& a) {
  return material_towards({x[0] / a[0], x[1] / a[1], x[2] / a[2]}, gauge<double>(x, a));
}

inline Material<double> SuperellipsoidRadial::mesh_label(const Vec3<double>& g, const Vec<double, 5>& a) {
  Vec<double, 5> unit = a;
  unit.head<3>().setOnes();
  const Vec3<double> x = Superellipsoid::e<double>(Superellipsoid::mesh_label(g, unit), unit);
  return material_towards(x);
}

}  // namespace pliant
