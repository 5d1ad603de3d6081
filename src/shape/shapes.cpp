// Material points, quadrature panels and sections of the shapes. These functions run once, when a scene is
// loaded.
#include <cmath>

#include <pliant/shape/all_shapes.h>

namespace pliant {

namespace {

constexpr double kQuarter = kPi / 4, kHalf = kPi / 2;

/// Returns the profile panels of shapes with rims at |u| = pi/4.
std::vector<Panel> rimmed_profile() {
  using K = Panel::Kind;
  return {{K::smooth, -kHalf, -kQuarter}, {K::smooth, -kQuarter, kQuarter}, {K::smooth, kQuarter, kHalf}};
}
/// Returns the ring panel of shapes with elliptic sections.
std::vector<Panel> round_ring() {
  return {{Panel::Kind::periodic, 0, 2 * kPi}};
}

}  // namespace

// Superellipsoid

Material<double> Superellipsoid::label(const Vec3<double>& x, const Vec<double, 5>& a) {
  const Vec3<double> unit{x[0] / a[0], x[1] / a[1], x[2] / a[2]};
  const double ring = power_norm<double>(std::abs(unit[0]), std::abs(unit[1]), 2 / a[4]);
  const auto [cv, sv] = superellipse_label(unit[0], unit[1], a[4]);
  if (ring == 0 && unit[2] == 0) return material_from(0, 1, 1, 0, 0);
  const auto [cu, su] = superellipse_label(ring, unit[2], a[3]);
  return {cu, su, cv, sv, gauge<double>(x, a)};
}

Material<double> Superellipsoid::mesh_label(const Vec3<double>& g, const Vec<double, 5>& a) {
  const auto [cv, sv] = superellipse_label(g[0], g[1], a[4]);
  const auto [cu, su] = superellipse_label(std::hypot(g[0], g[1]), g[2], a[3]);
  return {cu, su, cv, sv, 1.0};
}

std::vector<Panel> Superellipsoid::profile(const Vec<double, 5>& a, bool dynamic_exponents) {
  return half_circle_panels(a[3], dynamic_exponents);
}
std::vector<Panel> Superellipsoid::ring(const Vec<double, 5>& a, bool dynamic_exponents) {
  return circle_panels(a[4], dynamic_exponents);
}

Section Superellipsoid::section(double zeta, double gap, const Vec<double, 5>& a) {
  const double width = superellipse_width(zeta, gap, a[3]), width2 = width * width;
  const Section unit = superellipse_section(a[4]);
  return {unit.area * a[0] * a[1] * width2, unit.xx * a[0] * a[0] * width2, unit.yy * a[1] * a[1] * width2};
}
std::vector<SectionPanel> Superellipsoid::section_panels(const Vec<double, 5>& a) {
  return superellipse_section_panels(a[3]);
}

// Superellipsoid, radial map

Material<double> SuperellipsoidRadial::label(const Vec3<double>& x, const Vec<double, 5>& a) {
  return material_towards({x[0] / a[0], x[1] / a[1], x[2] / a[2]}, gauge<double>(x, a));
}

Material<double> SuperellipsoidRadial::mesh_label(const Vec3<double>& g, const Vec<double, 5>& a) {
  Vec<double, 5> unit = a;
  unit.head<3>().setOnes();
  const Vec3<double> x = Superellipsoid::e<double>(Superellipsoid::mesh_label(g, unit), unit);
  return material_towards(x);
}

// Ellipsoid

Material<double> Ellipsoid::label(const Vec3<double>& x, const Vec<double, 3>& a) {
  return material_towards({x[0] / a[0], x[1] / a[1], x[2] / a[2]}, gauge<double>(x, a));
}
std::vector<Panel> Ellipsoid::profile(const Vec<double, 3>&, bool) {
  return {{Panel::Kind::smooth, -kHalf, kHalf}};
}
std::vector<Panel> Ellipsoid::ring(const Vec<double, 3>&, bool) {
  return round_ring();
}
Section Ellipsoid::section(double zeta, double gap, const Vec<double, 3>& a) {
  const double width2 = gap * (1 + std::abs(zeta));
  return {kPi * a[0] * a[1] * width2, a[0] * a[0] * width2 / 4, a[1] * a[1] * width2 / 4};
}
std::vector<SectionPanel> Ellipsoid::section_panels(const Vec<double, 3>&) {
  return {{-1, 1, false}};
}

// Cylinder

Material<double> Cylinder::label(const Vec3<double>& x, const Vec<double, 3>& a) {
  return material_towards({x[0] / a[0], x[1] / a[1], x[2] / a[2]}, gauge<double>(x, a));
}
std::vector<Panel> Cylinder::profile(const Vec<double, 3>&, bool) {
  return rimmed_profile();
}
std::vector<Panel> Cylinder::ring(const Vec<double, 3>&, bool) {
  return round_ring();
}
Section Cylinder::section(double, double, const Vec<double, 3>& a) {
  return {kPi * a[0] * a[1], a[0] * a[0] / 4, a[1] * a[1] / 4};
}
std::vector<SectionPanel> Cylinder::section_panels(const Vec<double, 3>&) {
  return {{-1, 1, false}};
}

// Cone

Material<double> Cone::label(const Vec3<double>& x, const Vec<double, 4>& a) {
  const double w = gauge<double>(x, a);
  if (w == 0) return material_from(0, 1, 1, 0, 0);
  const double z = x[2] / (a[2] * w), width = 1 + a[3] * z;
  const double narrow = width > 1e-14 ? 1 / (width * w) : 0.0;
  return material_towards({x[0] / a[0] * narrow, x[1] / a[1] * narrow, z}, w);
}
Material<double> Cone::mesh_label(const Vec3<double>& g, const Vec<double, 4>& a) {
  const double ring = std::hypot(g[0], g[1]);
  const double tip = a[3] == -1 ? 1.0 : -1.0;
  if (std::abs(a[3]) != 1 || ring == 0 || tip * g[2] <= -ring) return material_towards(g);
  // Map the latitudes from the rim (-45 degrees) to the tip (90 degrees) linearly to z.
  const double rise = (std::atan2(tip * g[2], ring) + kQuarter) / (3 * kQuarter);
  const double k = tip * (2 * rise - 1), size = std::hypot(1.0, k);
  return material_from(1 / size, k / size, g[0] / ring, g[1] / ring);
}
std::vector<Panel> Cone::profile(const Vec<double, 4>&, bool) {
  return rimmed_profile();
}
std::vector<Panel> Cone::ring(const Vec<double, 4>&, bool) {
  return round_ring();
}
Section Cone::section(double zeta, double gap, const Vec<double, 4>& a) {
  // width = 1 + t zeta, without cancellation at the tip.
  const double end = zeta < 0 ? -1.0 : 1.0;
  const double width = (1 + a[3] * end) - a[3] * end * gap, width2 = width * width;
  return {kPi * a[0] * a[1] * width2, a[0] * a[0] * width2 / 4, a[1] * a[1] * width2 / 4};
}
std::vector<SectionPanel> Cone::section_panels(const Vec<double, 4>&) {
  return {{-1, 1, false}};
}

// Capsule

Material<double> Capsule::label(const Vec3<double>& x, const Vec<double, 2>& a) {
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
std::vector<Panel> Capsule::profile(const Vec<double, 2>&, bool) {
  return rimmed_profile();
}
std::vector<Panel> Capsule::ring(const Vec<double, 2>&, bool) {
  return round_ring();
}
Section Capsule::section(double zeta, double gap, const Vec<double, 2>& a) {
  const double h = a[0] + a[1] / 2, from_end = gap * h;  // distance from the pole
  const double beyond = std::abs(zeta) * h - a[1] / 2;
  const double r2 = beyond > 0 ? from_end * (a[0] + beyond) : a[0] * a[0];
  return {kPi * r2, r2 / 4, r2 / 4};
}
std::vector<SectionPanel> Capsule::section_panels(const Vec<double, 2>& a) {
  const double rim = a[1] / 2 / (a[0] + a[1] / 2);
  return {{-1, -rim, false}, {-rim, rim, false}, {rim, 1, false}};
}

// Box

Material<double> Box::label(const Vec3<double>& x, const Vec<double, 3>& a) {
  const Vec3<double> k{x[0] / a[0], x[1] / a[1], x[2] / a[2]};
  const double ring = std::max(std::abs(k[0]), std::abs(k[1])), size = std::hypot(ring, k[2]);
  const double round = std::hypot(k[0], k[1]);
  if (size == 0) return material_from(0, 1, 1, 0, 0);
  const double cv = round > 0 ? k[0] / round : 1.0, sv = round > 0 ? k[1] / round : 0.0;
  return material_from(ring / size, k[2] / size, cv, sv, gauge<double>(x, a));
}
std::vector<Panel> Box::profile(const Vec<double, 3>&, bool) {
  return rimmed_profile();
}
std::vector<Panel> Box::ring(const Vec<double, 3>&, bool) {
  std::vector<Panel> sides;
  for (int i = 0; i < 4; ++i)
    sides.push_back({Panel::Kind::smooth, (2 * i - 1) * kQuarter, (2 * i + 1) * kQuarter});
  return sides;
}
Section Box::section(double, double, const Vec<double, 3>& a) {
  return {4 * a[0] * a[1], a[0] * a[0] / 3, a[1] * a[1] / 3};
}
std::vector<SectionPanel> Box::section_panels(const Vec<double, 3>&) {
  return {{-1, 1, false}};
}

// Supertoroid

Material<double> Supertoroid::label(const Vec3<double>& x, const Vec<double, 6>& a) {
  const double ring = power_norm<double>(std::abs(x[0] / a[0]), std::abs(x[1] / a[1]), 2 / a[5]);
  const auto [cv, sv] = superellipse_label(x[0] / a[0], x[1] / a[1], a[5]);
  const auto [cu, su] = superellipse_label(ring - a[3], x[2] / a[2], a[4]);
  return {cu, su, cv, sv, gauge<double>(x, a)};
}
Material<double> Supertoroid::mesh_label(const Vec3<double>& g, const Vec<double, 6>& a) {
  const auto [cv, sv] = superellipse_label(std::cos(g[1]), std::sin(g[1]), a[5]);
  const auto [cu, su] = superellipse_label(std::cos(g[0]), std::sin(g[0]), a[4]);
  return {cu, su, cv, sv, 1.0};
}
std::vector<Panel> Supertoroid::profile(const Vec<double, 6>& a, bool dynamic_exponents) {
  return circle_panels(a[4], dynamic_exponents);
}
std::vector<Panel> Supertoroid::ring(const Vec<double, 6>& a, bool dynamic_exponents) {
  return circle_panels(a[5], dynamic_exponents);
}
Section Supertoroid::section(double zeta, double gap, const Vec<double, 6>& a) {
  const double q = superellipse_width(zeta, gap, a[4]), inner = a[3] - q, outer = a[3] + q;
  const Section unit = superellipse_section(a[5]);
  // The section is between two similar superellipses. In units of the unit superellipse its area is outer^2 -
  // inner^2 = 4 a4 q, and its mean square is outer^2 + inner^2.
  const double area = 4 * a[3] * q, spread = inner * inner + outer * outer;
  return {unit.area * a[0] * a[1] * area, unit.xx * a[0] * a[0] * spread, unit.yy * a[1] * a[1] * spread};
}
std::vector<SectionPanel> Supertoroid::section_panels(const Vec<double, 6>&) {
  return {{-1, 0, true}, {0, 1, true}};
}

}  // namespace pliant
