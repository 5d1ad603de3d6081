// Elliptic cylinder: e = w diag(a1, a2, a3) k. The point k is on the surface of the unit cylinder,
// |(k_x, k_y)| <= 1 and |k_z| <= 1, in the direction n = (C_u C_v, C_u S_v, S_u). The rim is at |u| = pi/4.
#pragma once

#include <pliant/shape/shape.h>

namespace pliant {

struct Cylinder {
  static constexpr const char* name = "cylinder";
  static constexpr const char* formula =
      "w diag(a1, a2, a3) n / max(|C_u|, |S_u|), n = (C_u C_v, C_u S_v, S_u)";
  static constexpr std::array<ParameterSpec, 3> parameters{{
      length("a1", 1, "semi-axis along x"),
      length("a2", 1, "semi-axis along y"),
      length("a3", 1, "half height along z"),
  }};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;

  /// Returns the surface point k of the unit cylinder in the direction of m.
  template <class U>
  static Vec3<U> unit_point(const Material<U>& m) {
    const U reach = U(1) / math::max(math::abs(m.cu.x), math::abs(m.su.x));
    const U rim = m.cu.x * reach;
    return {rim * m.cv.x, rim * m.sv.x, m.su.x * reach};
  }
  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 3>& a) {
    const Vec3<U> k = unit_point(m);
    return {a[0] * U(m.w * k[0]), a[1] * U(m.w * k[1]), a[2] * U(m.w * k[2])};
  }
  template <class T>
  static T half_height(const Vec<T, 3>& a) {
    return a[2];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 3>& a) {
    const T ring2 = math::square(T(x[0] / a[0])) + math::square(T(x[1] / a[1]));
    return math::max(math::sqrt_from_zero(ring2), T(math::abs(x[2]) / a[2]));
  }
  /// The pieces of the hull are the two end faces, which are ellipses; piece 0 is the upper face.
  static constexpr int hull_pieces = 2;
  static constexpr bool has_end_faces = true;
  static bool has_flat_regions(const Vec<double, 3>&) { return false; }
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 3>& a, int piece) {
    const Vec<T, 2> rim = ellipse_support(m, a[0], a[1]);
    return {rim[0], rim[1], a[2] * (piece == 0 ? 1.0 : -1.0)};
  }
  /// Returns the point of the ellipse with semi-axes a1 and a2 (m) that is farthest in the direction of (m_x,
  /// m_y); (a1, 0) if both are zero.
  template <class T>
  static Vec<T, 2> ellipse_support(const Vec3<T>& m, const T& a1, const T& a2) {
    const T x = a1 * m[0], y = a2 * m[1];
    const T square = x * x + y * y - 1e-300;
    const T h = math::sqrt(math::where_positive(square, T(x * x + y * y), T(1)));
    return {math::where_positive(square, T(a1 * x / h), a1),
            math::where_positive(square, T(a2 * y / h), T(0))};
  }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 3>& a);
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 3>&) {
    return material_towards(g);
  }
  static std::vector<Panel> profile(const Vec<double, 3>& a, bool);
  static std::vector<Panel> ring(const Vec<double, 3>& a, bool);
  static Section section(double zeta, double gap, const Vec<double, 3>& a);
  static std::vector<SectionPanel> section_panels(const Vec<double, 3>& a);
};

inline Material<double> Cylinder::label(const Vec3<double>& x, const Vec<double, 3>& a) {
  return material_towards({x[0] / a[0], x[1] / a[1], x[2] / a[2]}, gauge<double>(x, a));
}
inline std::vector<Panel> Cylinder::profile(const Vec<double, 3>&, bool) {
  return detail::rimmed_profile();
}
inline std::vector<Panel> Cylinder::ring(const Vec<double, 3>&, bool) {
  return detail::round_ring();
}
inline Section Cylinder::section(double, double, const Vec<double, 3>& a) {
  return {kPi * a[0] * a[1], a[0] * a[0] / 4, a[1] * a[1] / 4};
}
inline std::vector<SectionPanel> Cylinder::section_panels(const Vec<double, 3>&) {
  return {{-1, 1, false}};
}

}  // namespace pliant
