// Capsule: a cylinder of radius r and length l along z between two half balls. The side has |u| <= pi/4, and
// the caps have |u| > pi/4. On a cap, the polar angle about the centre of the half ball is 2 (pi/2 - |u|).
// e is w times the surface point:
//   side  (r C_v, r S_v, (l/2) tan u)
//   cap   (2 r C_u |S_u| C_v, 2 r C_u |S_u| S_v, sgn(u) (l/2 + r (S_u^2 - C_u^2)))
#pragma once

#include <cmath>

#include <pliant/shape/shape.h>

namespace pliant {

struct Capsule {
  static constexpr const char* name = "capsule";
  static constexpr const char* formula =
      "side: w (r C_v, r S_v, (l/2) tan u); caps: w (r sin 2p C_v, r sin 2p S_v, +-(l/2 + r cos 2p)), p = "
      "pi/2 - |u|";
  static constexpr std::array<ParameterSpec, 2> parameters{{
      length("r", 0.5, "radius", Follows::ring),
      length("l", 1, "length of the straight part", Follows::ring),
  }};
  static constexpr MeshPattern mesh = MeshPattern::ball;
  static constexpr bool linear_lengths = true;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 2>& a) {
    const U s = math::abs(m.su.x), c = m.cu.x;
    const U beyond = s - c;  // positive on the caps
    const U steep = math::where_positive(beyond, U(1), c);
    const U ring = math::where_positive(beyond, U(s * c * 2.0), U(1)) * m.w;
    const U straight = math::where_positive(beyond, U(m.su.sign), U(m.su.x / steep)) * m.w;
    const U round = math::where_positive(beyond, U((s * s - c * c) * m.su.sign), U(0)) * m.w;
    return {a[0] * U(ring * m.cv.x), a[0] * U(ring * m.sv.x), a[1] * U(straight * 0.5) + a[0] * round};
  }
  template <class T>
  static T half_height(const Vec<T, 2>& a) {
    return a[0] + a[1] * 0.5;
  }
  template <class T>
  static T gauge(const Vec3<T>& x, const Vec<T, 2>& a) {
    const T half = a[1] * 0.5, z = math::abs(x[2]);
    const T ring2 = x[0] * x[0] + x[1] * x[1];
    const T ring = math::sqrt_from_zero(ring2);
    const T side = ring / a[0];
    const T on_cap = z - half * side;
    // Cap: ring^2 + (z - w half)^2 = (w r)^2, i.e. (r^2 - half^2) w^2 + 2 half z w - (ring^2 + z^2) = 0; w is
    // the smallest positive root.
    const T s2 = ring2 + z * z;
    const T root2 = half * half * z * z + (a[0] * a[0] - half * half) * s2;
    const T off_centre = root2 - T(1e-300);
    const T root = math::sqrt(math::where_positive(off_centre, root2, T(1)));
    const T below = half * z + root;
    const T cap = s2 / math::where_positive(below, below, T(1));
    return math::where_positive(on_cap, math::where_positive(off_centre, cap, T(0)), side);
  }
  /// The pieces of the hull are the two end balls; piece 0 is the upper ball.
  static constexpr int hull_pieces = 2;
  template <class T>
  static Vec3<T> support(const Vec3<T>& m, const Vec<T, 2>& a, int piece) {
    const T scale = a[0] / math::sqrt(T(m[0] * m[0] + m[1] * m[1] + m[2] * m[2]));
    return {m[0] * scale, m[1] * scale, m[2] * scale + a[1] * (piece == 0 ? 0.5 : -0.5)};
  }
  static bool has_flat_regions(const Vec<double, 2>&) { return false; }
  static Material<double> label(const Vec3<double>& x, const Vec<double, 2>& a);
  static Material<double> mesh_label(const Vec3<double>& g, const Vec<double, 2>&) {
    return material_towards(g);
  }
  static std::vector<Panel> profile(const Vec<double, 2>& a, bool);
  static std::vector<Panel> ring(const Vec<double, 2>& a, bool);
  static Section section(double zeta, double gap, const Vec<double, 2>& a);
  static std::vector<SectionPanel> section_panels(const Vec<double, 2>& a);
};

inline Material<double> Capsule::label(const Vec3<double>& x, const Vec<double, 2>& a) {
  const double w = gauge<double>(x, a), half = a[1] / 2;
  const double ring = std::hypot(x[0], x[1]);
  if (w == 0) return material_from(0, 1, 1, 0, 0);
  const double cv = ring > 0 ? x[0] / ring : 1.0, sv = ring > 0 ? x[1] / ring : 0.0;
  const double z = x[2] / w;
  if (std::abs(z) <= half) {
    const double size = std::hypot(1.0, z / half);
    return material_from(1 / size, z / half / size, cv, sv, w);
  }
  const double polar = std::atan2(ring / w, std::abs(z) - half) / 2;
  return material_from(std::sin(polar), std::copysign(std::cos(polar), z), cv, sv, w);
}
inline std::vector<Panel> Capsule::profile(const Vec<double, 2>&, bool) {
  return detail::rimmed_profile();
}
inline std::vector<Panel> Capsule::ring(const Vec<double, 2>&, bool) {
  return detail::round_ring();
}
inline Section Capsule::section(double zeta, double gap, const Vec<double, 2>& a) {
  const double h = a[0] + a[1] / 2, from_end = gap * h;  // h - |z|: distance from the pole along z
  const double beyond = std::abs(zeta) * h - a[1] / 2;
  const double r2 = beyond > 0 ? from_end * (a[0] + beyond) : a[0] * a[0];
  return {kPi * r2, r2 / 4, r2 / 4};
}
inline std::vector<SectionPanel> Capsule::section_panels(const Vec<double, 2>& a) {
  const double rim = a[1] / 2 / (a[0] + a[1] / 2);
  return {{-1, -rim, false}, {-rim, rim, false}, {rim, 1, false}};
}

}  // namespace pliant
