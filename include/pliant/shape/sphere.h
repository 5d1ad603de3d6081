// Sphere of radius r: e = w r (C_u C_v, C_u S_v, S_u), -pi/2 <= u <= pi/2.
#pragma once

#include <pliant/shape/ellipsoid.h>

namespace pliant {

struct Sphere {
  static constexpr const char* name = "sphere";
  static constexpr const char* formula = "w r (C_u C_v, C_u S_v, S_u)";
  static constexpr std::array<ParameterSpec, 1> parameters{{length("r", 1, "radius")}};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 1>& a) {
    return {a[0] * U(m.w * m.cu.x * m.cv.x), a[0] * U(m.w * m.cu.x * m.sv.x), a[0] * U(m.w * m.su.x)};
  }
  template <class T>
  static T half_height(const Vec<T, 1>& a) {
    return a[0];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 1>& a) {
    const Vec3<T> y{x[0] / a[0], x[1] / a[0], x[2] / a[0]};
    return math::sqrt_from_zero(T(y[0] * y[0] + y[1] * y[1] + y[2] * y[2]));
  }
  static constexpr int hull_pieces = 1;
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 1>& a, int) {
    const T scale = a[0] / math::sqrt(T(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]));
    return {m[0] * scale, m[1] * scale, m[2] * scale};
  }
  static bool has_flat_regions(const Vec<double, 1>&) { return false; }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 1>& a) {
    return Ellipsoid::label(x, Vec3<double>::Constant(a[0]));
  }
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 1>&) {
    return material_towards(g);
  }
  static Vec3<double> semi_axes(const Vec<double, 1>& a) { return Vec3<double>::Constant(a[0]); }
  static std::vector<Panel> profile(const Vec<double, 1>& a, bool) {
    return Ellipsoid::profile(Vec3<double>::Constant(a[0]), false);
  }
  static std::vector<Panel> ring(const Vec<double, 1>& a, bool) {
    return Ellipsoid::ring(Vec3<double>::Constant(a[0]), false);
  }
  static Section section(double zeta, double gap, const Vec<double, 1>& a) {
    return Ellipsoid::section(zeta, gap, Vec3<double>::Constant(a[0]));
  }
  static std::vector<SectionPanel> section_panels(const Vec<double, 1>& a) {
    return Ellipsoid::section_panels(Vec3<double>::Constant(a[0]));
  }
};

}  // namespace pliant
