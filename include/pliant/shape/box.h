// Box with half sizes a1, a2, a3. With (X, Y) on the edge of the square |X|, |Y| <= 1,
//   (X, Y) = (C_v, S_v) / max(|C_v|, |S_v|),   e = w diag(a1, a2, a3) (C_u X, C_u Y, S_u) / max(|C_u|, |S_u|)
#pragma once

#include <algorithm>
#include <cmath>

#include <pliant/shape/shape.h>

namespace pliant {

struct Box {
  static constexpr const char* name = "box";
  static constexpr const char* formula =
      "w diag(a1, a2, a3) (C_u X, C_u Y, S_u) / max(|C_u|, |S_u|), (X, Y) = (C_v, S_v) / max(|C_v|, |S_v|)";
  static constexpr std::array<ParameterSpec, 3> parameters{{
      length("a1", 1, "half size along x"),
      length("a2", 1, "half size along y"),
      length("a3", 1, "half size along z"),
  }};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 3>& a) {
    const U reach = m.w / math::max(U(math::abs(m.cu.x)), U(math::abs(m.su.x)));
    const U rim = m.cu.x * reach / math::max(U(math::abs(m.cv.x)), U(math::abs(m.sv.x)));
    return {a[0] * U(rim * m.cv.x), a[1] * U(rim * m.sv.x), a[2] * U(reach * m.su.x)};
  }
  template <class T>
  static T half_height(const Vec<T, 3>& a) {
    return a[2];
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 3>& a) {
    return math::max(math::max(T(math::abs(x[0]) / a[0]), T(math::abs(x[1]) / a[1])),
                     T(math::abs(x[2]) / a[2]));
  }
  /// The pieces of the hull are the eight corners. Bit k of the number of a piece is 1 if coordinate k is
  /// negative.
  static constexpr int hull_pieces = 8;
  template <class T>
  static Vec3<T> support(const Vec3<T>&, const Vec<T, 3>& a, int piece) {
    auto sign = [&](int k) { return (piece >> k & 1) != 0 ? -1.0 : 1.0; };
    return {a[0] * sign(0), a[1] * sign(1), a[2] * sign(2)};
  }
  static bool has_flat_regions(const Vec<double, 3>&) { return false; }
  static Vec3<double> half_sizes(const Vec<double, 3>& a) { return a; }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 3>& a);
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 3>&) {
    return material_towards(g);
  }
  static std::vector<Panel> profile(const Vec<double, 3>& a, bool);
  static std::vector<Panel> ring(const Vec<double, 3>& a, bool);
  static Section section(double zeta, double gap, const Vec<double, 3>& a);
  static std::vector<SectionPanel> section_panels(const Vec<double, 3>& a);
};

inline Material<double> Box::label(const Vec3<double>& x, const Vec<double, 3>& a) {
  const Vec3<double> k{x[0] / a[0], x[1] / a[1], x[2] / a[2]};
  const double ring = std::max(std::abs(k[0]), std::abs(k[1])), size = std::hypot(ring, k[2]);
  const double round = std::hypot(k[0], k[1]);
  if (size == 0) return material_from(0, 1, 1, 0, 0);
  const double cv = round > 0 ? k[0] / round : 1.0, sv = round > 0 ? k[1] / round : 0.0;
  return material_from(ring / size, k[2] / size, cv, sv, gauge<double>(x, a));
}
inline std::vector<Panel> Box::profile(const Vec<double, 3>&, bool) {
  return detail::rimmed_profile();
}
inline std::vector<Panel> Box::ring(const Vec<double, 3>&, bool) {
  std::vector<Panel> sides;
  for (int i = 0; i < 4; ++i)
    sides.push_back({Panel::Kind::smooth, (2 * i - 1) * detail::kRimAngle, (2 * i + 1) * detail::kRimAngle});
  return sides;
}
inline Section Box::section(double, double, const Vec<double, 3>& a) {
  return {4 * a[0] * a[1], a[0] * a[0] / 3, a[1] * a[1] / 3};
}
inline std::vector<SectionPanel> Box::section_panels(const Vec<double, 3>&) {
  return {{-1, 1, false}};
}

}  // namespace pliant
