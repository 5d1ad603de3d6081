// Ellipsoid: e = w (a1 C_u C_v, a2 C_u S_v, a3 S_u), -pi/2 <= u <= pi/2.
#pragma once

#include <cmath>

#include <pliant/shape/shape.h>

namespace pliant {

struct Ellipsoid {
  static constexpr const char* name = "ellipsoid";
  static constexpr const char* formula = "w (a1 C_u C_v, a2 C_u S_v, a3 S_u)";
  static constexpr std::array<ParameterSpec, 3> parameters{{
      length("a1", 1, "semi-axis along x"),
      length("a2", 1, "semi-axis along y"),
      length("a3", 1, "semi-axis along z"),
  }};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 3>& a) {
    return {a[0] * U(m.w * m.cu.x * m.cv.x), a[1] * U(m.w * m.cu.x * m.sv.x), a[2] * U(m.w * m.su.x)};
  }
  template <class T>
  static T half_height(const Vec<T, 3>& a) {
    return a[2];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 3>& a) {
    return math::sqrt_from_zero(
        T(math::square(T(x[0] / a[0])) + math::square(T(x[1] / a[1])) + math::square(T(x[2] / a[2]))));
  }
  static constexpr int hull_pieces = 1;
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 3>& a, int) {
    const Vec3<T> y{a[0] * m[0], a[1] * m[1], a[2] * m[2]};
    const T h = math::sqrt(T(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]));
    return {a[0] * y[0] / h, a[1] * y[1] / h, a[2] * y[2] / h};
  }
  static bool has_flat_regions(const Vec<double, 3>&) { return false; }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 3>& a);
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 3>&) {
    return material_towards(g);
  }
  static Vec3<double> semi_axes(const Vec<double, 3>& a) { return a; }
  static std::vector<Panel> profile(const Vec<double, 3>& a, bool);
  static std::vector<Panel> ring(const Vec<double, 3>& a, bool);
  static Section section(double zeta, double gap, const Vec<double, 3>& a);
  static std::vector<SectionPanel> section_panels(const Vec<double, 3>& a);
};

inline Material<double> Ellipsoid::label(const Vec3<double>& x, const Vec<double, 3>& a) {
  return material_towards({x[0] / a[0], x[1] / a[1], x[2] / a[2]}, gauge<double>(x, a));
}
inline std::vector<Panel> Ellipsoid::profile(const Vec<double, 3>&, bool) {
  return {{Panel::Kind::smooth, -detail::kPoleAngle, detail::kPoleAngle}};
}
inline std::vector<Panel> Ellipsoid::ring(const Vec<double, 3>&, bool) {
  return detail::round_ring();
}
inline Section Ellipsoid::section(double zeta, double gap, const Vec<double, 3>& a) {
  const double width2 = gap * (1 + std::abs(zeta));
  return {kPi * a[0] * a[1] * width2, a[0] * a[0] * width2 / 4, a[1] * a[1] * width2 / 4};
}
inline std::vector<SectionPanel> Ellipsoid::section_panels(const Vec<double, 3>&) {
  return {{-1, 1, false}};
}

}  // namespace pliant
