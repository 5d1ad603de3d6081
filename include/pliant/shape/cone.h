// Cone and frustum: a cylinder whose section is scaled by the factor 1 + t z / a3. For t = -1 the shape is a
// cone with its tip at z = a3. With the surface point k of the unit cylinder (cylinder.h),
//   e = w (a1 k_x (1 + t k_z), a2 k_y (1 + t k_z), a3 k_z)
#pragma once

#include <cmath>

#include <pliant/shape/cylinder.h>

namespace pliant {

struct Cone {
  static constexpr const char* name = "cone";
  static constexpr const char* formula =
      "w (a1 k_x (1 + t k_z), a2 k_y (1 + t k_z), a3 k_z), k on the unit cylinder";
  static constexpr std::array<ParameterSpec, 4> parameters{{
      length("a1", 1, "semi-axis along x at mid height"),
      length("a2", 1, "semi-axis along y at mid height"),
      length("a3", 1, "half height along z"),
      ratio("t", -1, {-1, 1}, {-1, 1}, "slope of the side: -1 is a cone with its tip up, 0 is a cylinder",
            Follows::ring),
  }};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 4>& a) {
    const Vec3<U> k = Cylinder::unit_point(m);
    const T width = (a[3] * k[2] + 1.0) * m.w;
    return {a[0] * width * k[0], a[1] * width * k[1], a[2] * U(m.w * k[2])};
  }
  template <class T>
  static T half_height(const Vec<T, 4>& a) {
    return a[2];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 4>& a) {
    const T ring2 = math::square(T(x[0] / a[0])) + math::square(T(x[1] / a[1]));
    const T ring = math::sqrt_from_zero(ring2);
    const T zeta = x[2] / a[2];
    return math::max(T(ring - a[3] * zeta), T(math::abs(zeta)));
  }
  /// The pieces of the hull are the two end faces; piece 0 is the upper face. A tip is an end face of size
  /// zero.
  static constexpr int hull_pieces = 2;
  static constexpr bool has_end_faces = true;
  static bool has_flat_regions(const Vec<double, 4>&) { return false; }
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 4>& a, int piece) {
    const double end = piece == 0 ? 1.0 : -1.0;
    const T width = a[3] * end + 1.0;
    const Vec<T, 2> rim = Cylinder::ellipse_support(m, a[0], a[1]);
    return {width * rim[0], width * rim[1], a[2] * end};
  }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 4>& a);
  /// Returns the surface point for direction g of the mesh pattern. A cone with a tip (|t| = 1) has only one
  /// end face; the vertices of the missing end face are moved to the side.
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 4>& a);
  static std::vector<Panel> profile(const Vec<double, 4>& a, bool);
  static std::vector<Panel> ring(const Vec<double, 4>& a, bool);
  static Section section(double zeta, double gap, const Vec<double, 4>& a);
  static std::vector<SectionPanel> section_panels(const Vec<double, 4>& a);
};

inline Material<double> Cone::label(const Vec3<double>& x, const Vec<double, 4>& a) {
  const double w = gauge<double>(x, a);
  if (w == 0) return material_from(0, 1, 1, 0, 0);
  const double z = x[2] / (a[2] * w), width = 1 + a[3] * z;
  const double narrow = width > 1e-14 ? 1 / (width * w) : 0.0;
  return material_towards({x[0] / a[0] * narrow, x[1] / a[1] * narrow, z}, w);
}
inline Material<double> Cone::mesh_label(const Vec3<double>& g, const Vec<double, 4>& a) {
  const double ring = std::hypot(g[0], g[1]);
  const double tip = a[3] == -1 ? 1.0 : -1.0;
  if (std::abs(a[3]) != 1 || ring == 0 || tip * g[2] <= -ring) return material_towards(g);
  // Map the latitude, positive towards the tip, linearly to z: -45 degrees is the rim, 90 degrees the tip.
  const double rise = (std::atan2(tip * g[2], ring) + detail::kRimAngle) / (3 * detail::kRimAngle);
  const double k = tip * (2 * rise - 1), size = std::hypot(1.0, k);
  return material_from(1 / size, k / size, g[0] / ring, g[1] / ring);
}
inline std::vector<Panel> Cone::profile(const Vec<double, 4>&, bool) {
  return detail::rimmed_profile();
}
inline std::vector<Panel> Cone::ring(const Vec<double, 4>&, bool) {
  return detail::round_ring();
}
inline Section Cone::section(double zeta, double gap, const Vec<double, 4>& a) {
  // width = 1 + t zeta, without cancellation at the tip.
  const double end = zeta < 0 ? -1.0 : 1.0;
  const double width = (1 + a[3] * end) - a[3] * end * gap, width2 = width * width;
  return {kPi * a[0] * a[1] * width2, a[0] * a[0] * width2 / 4, a[1] * a[1] * width2 / 4};
}
inline std::vector<SectionPanel> Cone::section_panels(const Vec<double, 4>&) {
  return {{-1, 1, false}};
}

}  // namespace pliant
