// Points of plane sections and of material rings at rest.
#include "rest_rules.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace pliant {

namespace {

/// Returns how material points follow the dynamic parameters, with the chain of deformations included.
Follows follows(const Part& part) {
  const Parameters& all = part.parameters();
  Follows worst = Follows::affine;
  for (int i : all.dynamic()) worst = std::max(worst, all[i].spec->follows);
  bool tilted = false;
  for (const LinkInfo& link : all.links()) {
    if (tilted && link.sections != Sections::stay_affine) return Follows::free;
    if (link.sections != Sections::stay_affine) worst = std::max(worst, Follows::section);
    tilted = tilted || link.sections == Sections::tilt;
  }
  // A bend tilts the sections. A shear after the bend depends on z, which then varies over a section. The
  // shear is affine in (x, y, z), however, so that plane sections stay plane: the result is not
  // Follows::free.
  return worst;
}

bool has_dynamic_exponent(const Part& part) {
  for (int i : part.parameters().dynamic())
    if (part.parameters()[i].spec->quantity == Quantity::exponent) return true;
  return false;
}

/// Moments of masses in a plane.
struct PlaneMoments {
  double m = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0;
  void add(double mass, double px, double py) {
    m += mass;
    x += mass * px;
    y += mass * py;
    xx += mass * px * px;
    xy += mass * px * py;
    yy += mass * py * py;
  }
  /// Returns three positions. Three equal masses at these positions have the centre and the second moments of
  /// all masses that were added.
  std::array<Eigen::Vector2d, 3> points() const {
    const double cx = x / m, cy = y / m;
    Eigen::Matrix2d spread;
    spread << xx / m - cx * cx, xy / m - cx * cy, xy / m - cx * cy, yy / m - cy * cy;
    const Eigen::Matrix2d L = spread.llt().matrixL();
    std::array<Eigen::Vector2d, 3> three;
    for (int k = 0; k < 3; ++k) {
      const double angle = kPi * (0.5 + 2.0 * k / 3.0);
      three[static_cast<std::size_t>(k)] =
          Eigen::Vector2d(cx, cy) + std::sqrt(2.0) * L * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    }
    return three;
  }
};

/// Returns a sine or cosine with its derivative along material direction number `slot`.
Trig<Dual<3>> lift(const Trig<Dual<1>>& t, std::size_t slot) {
  Trig<Dual<3>> r{Dual<3>(t.x.v), Dual<3>(t.sign.v), Dual<3>(t.log_abs.v)};
  r.x.d[slot] = t.x.d[0];
  r.log_abs.d[slot] = t.log_abs.d[0];
  return r;
}
/// Returns a sine or cosine without its derivative.
Trig<double> drop(const Trig<Dual<1>>& t) {
  return {t.x.v, t.sign.v, t.log_abs.v};
}

/// Four of the eight mirror images by the coordinate planes. The first moments and products of inertia of
/// these four images are zero, as for all eight images.
constexpr std::array<MirrorSigns, 4> kImages{{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}}};

Trig<double> times_sign(Trig<double> t, double sign) {
  t.x *= sign;
  t.sign *= sign;
  return t;
}

/// Returns whether the rings of a shape are plane, from a sample. Rings of a shape of the user need not be
/// plane. Three points cannot represent a ring that is not plane.
bool plane_rings(const RestShape& r) {
  for (const AngleNode& u : profile_nodes(r, 3)) {
    double low = kInfinity, high = -kInfinity;
    for (const AngleNode& v : ring_nodes(r, 3)) {
      const double z = r.part.shape().e({drop(u.c), drop(u.s), drop(v.c), drop(v.s), 1.0}, r.a)[2];
      low = std::min(low, z);
      high = std::max(high, z);
    }
    if (high - low > 1e-12 * r.part.size()) return false;
  }
  return true;
}

}  // namespace

RestShape::RestShape(const Part& whole, const MassDistribution* mass_distribution)
    : part(whole),
      distribution(mass_distribution),
      rest(whole.parameters().rest()),
      a(rest.b.data()),
      follows(pliant::follows(whole)),
      dynamic_exponents(has_dynamic_exponent(whole)) {
  if (dynamic_exponents) find_kinks();
  // The moments of sections have closed forms only if the density is the same everywhere.
  by_sections =
      distribution == nullptr && !part.shell() && follows <= Follows::section && part.shape().has_sections();
  points_apart =
      follows == Follows::free || (!by_sections && follows != Follows::ring && !plane_rings(*this));
}

void RestShape::find_kinks() {
  // Without bounded exponents a shape has the trigonometric map. For all exponents its integrands vary
  // fastest at u or v = 45 degrees, which is the default of Kinks.
  if (!part.shape().bounded_exponents()) return;
  // In the radial map, the edges of a superellipsoid move over the material when its exponents change. With
  // y = log |tan| of the angles u and v at rest, and exponents eps1 and eps2 at rest: an edge is at y(v) = 0,
  // and others are between y(u) = 0 and y(u) = (log 2 / 2) (eps2_now - eps2) / eps1, with the
  // present value eps2_now. Kinks::width is proportional to the ratio of the least exponent to its rest
  // value.
  std::vector<Range> values;
  std::vector<double> at_rest;
  for (int i = 0; i < part.parameters().size(); ++i) {
    const Parameter& p = part.parameters()[i];
    if (p.spec->quantity != Quantity::exponent) continue;
    at_rest.push_back(rest.b[static_cast<std::size_t>(i)]);
    values.push_back(p.dynamic ? p.limits : Range{at_rest.back(), at_rest.back()});
  }
  if (values.size() != 2) return;
  const double far = std::log(2.0) / 2 / at_rest[0];
  along_u.from = far * std::min(values[1].min - at_rest[1], 0.0);
  along_u.to = far * std::max(values[1].max - at_rest[1], 0.0);
  along_u.width = kPi / 2 * std::min(values[0].min / at_rest[0], 1.0);
  along_v.width = kPi / 2 * std::min(values[1].min / at_rest[1], 1.0);
}

bool octant_panels(const RestShape& r) {
  const auto power = [](const Panel& panel) { return panel.kind == Panel::Kind::power; };
  const std::vector<Panel> u = r.part.shape().profile(r.a, r.dynamic_exponents),
                           v = r.part.shape().ring(r.a, r.dynamic_exponents);
  return std::all_of(u.begin(), u.end(), power) && std::all_of(v.begin(), v.end(), power);
}

Material<double> mirrored(const Material<double>& m, const MirrorSigns& signs) {
  return {m.cu, times_sign(m.su, signs[2]), times_sign(m.cv, signs[0]), times_sign(m.sv, signs[1]), m.w};
}

std::vector<SliceNode> slice_nodes(const RestShape& r, int n) {
  std::vector<SliceNode> nodes;
  for (const SectionPanel& panel : r.part.shape().section_panels(r.a)) {
    const double extent = panel.to - panel.from;
    for (const QuadratureNode& node : panel.singular ? both_ends_rule(n) : gauss_rule(n)) {
      const double zeta = panel.from + extent * node.x;
      const double gap = zeta < 0 ? (panel.from + 1) + extent * node.x : (1 - panel.to) + extent * node.gap;
      nodes.push_back({zeta, gap, extent * node.weight});
    }
  }
  return nodes;
}

void add_slice(const RestShape& r, const SliceNode& node, std::vector<RestPoint>& out) {
  const ShapeInterface& shape = r.part.shape();
  const double h = shape.half_height(r.a), z = node.zeta * h;
  const Section section = shape.section(node.zeta, node.gap, r.a);
  if (!(section.area > 0)) return;
  const double half_x = std::sqrt(section.xx), half_y = std::sqrt(section.yy);
  // The determinant of the chain is affine in (x, y) on each section, so three samples suffice.
  Eigen::Matrix3Xd samples(3, 3);
  samples << 0, half_x, 0, 0, 0, half_y, z, z, z;
  const std::vector<Mat3<double>> F = r.part.chain_gradient(samples, r.rest);
  const double d0 = F[0].determinant(), dx = F[1].determinant() - d0, dy = F[2].determinant() - d0;
  if (!(d0 > 0)) {
    if (d0 == 0) return;  // the tip of a full taper has no mass
    throw_folded(r.part, "rest");
  }
  const double m = section.area * h * node.weight;
  PlaneMoments moments;
  moments.m = m * d0;
  moments.x = m * dx * half_x;
  moments.y = m * dy * half_y;
  moments.xx = m * d0 * section.xx;
  moments.yy = m * d0 * section.yy;
  for (const Eigen::Vector2d& p : moments.points())
    out.push_back({shape.label({p[0], p[1], z}, r.a), moments.m / 3});
}

namespace {

std::vector<AngleNode> angle_nodes(const RestShape& r, const std::vector<Panel>& panels, int n,
                                   const Kinks& kinks) {
  return r.dynamic_exponents ? angle_nodes(panels, n, kinks) : angle_nodes(panels, n);
}

}  // namespace

std::vector<AngleNode> profile_nodes(const RestShape& r, int n) {
  std::vector<Panel> panels = r.part.shape().profile(r.a, r.dynamic_exponents);
  if (r.octant)
    panels.erase(std::remove_if(panels.begin(), panels.end(), [](const Panel& p) { return p.sign_sin < 0; }),
                 panels.end());
  return angle_nodes(r, panels, n, r.along_u);
}
std::vector<AngleNode> ring_nodes(const RestShape& r, int n) {
  std::vector<Panel> panels = r.part.shape().ring(r.a, r.dynamic_exponents);
  if (r.octant)
    panels.erase(std::remove_if(panels.begin(), panels.end(),
                                [](const Panel& p) { return p.sign_cos < 0 || p.sign_sin < 0; }),
                 panels.end());
  return angle_nodes(r, panels, n, r.along_v);
}
std::vector<QuadratureNode> depth_nodes(const RestShape& r, int n) {
  if (r.part.shell()) return {{1, 0, 1}};
  return gauss_rule(n);
}

namespace {

/// The nodes of a ring: positions e of the rest map, before the chain of deformations, and the tangents
/// [e_u e_v e_w]. The derivatives are by the variables of the rules along u, v and w.
struct RingTangents {
  Eigen::Matrix3Xd e;
  std::vector<Mat3<double>> tangents;

  RingTangents(const RestShape& r, const AngleNode& u, const QuadratureNode& w,
               const std::vector<AngleNode>& v_nodes)
      : e(3, static_cast<Eigen::Index>(v_nodes.size())), tangents(v_nodes.size()) {
    for (std::size_t k = 0; k < v_nodes.size(); ++k) {
      const AngleNode& v = v_nodes[k];
      const Material<Dual<3>> m{lift(u.c, 0), lift(u.s, 0), lift(v.c, 1), lift(v.s, 1),
                                Dual<3>::variable(w.x, 2)};
      const Vec3<Dual<3>> at = r.part.shape().rest_tangents(m, r.a);
      for (int i = 0; i < 3; ++i) {
        e(i, static_cast<Eigen::Index>(k)) = at[i].v;
        for (int j = 0; j < 3; ++j) tangents[k](i, j) = at[i].d[static_cast<std::size_t>(j)];
      }
    }
  }
};

/// Returns the material point of a ring at p = (C_v^eps, S_v^eps), where eps is the exponent of the ring.
Material<double> on_ring(const AngleNode& u, const QuadratureNode& w, const Eigen::Vector2d& p,
                         double ring_exponent) {
  auto coordinate = [&](double x) {
    Trig<double> t = trig(x);
    if (x != 0) t.log_abs /= ring_exponent;
    return t;
  };
  return {drop(u.c), drop(u.s), coordinate(p[0]), coordinate(p[1]), w.x};
}

/// Returns the material point at nodes of u, v and w.
Material<double> material_at(const RestShape& r, const AngleNode& u, const AngleNode& v,
                             const QuadratureNode& w) {
  return r.part.shape().from_rest_map({drop(u.c), drop(u.s), drop(v.c), drop(v.s), w.x}, r.a);
}

/// Returns the masses of the points of a ring, for Part::density() = 1.
Eigen::VectorXd ring_masses(const RestShape& r, const AngleNode& u, const QuadratureNode& w,
                            const std::vector<AngleNode>& v, const RingTangents& nodes) {
  const std::vector<Mat3<double>> F = r.part.chain_gradient(nodes.e, r.rest);
  Eigen::VectorXd masses(static_cast<Eigen::Index>(v.size()));
  for (std::size_t k = 0; k < v.size(); ++k) {
    const Mat3<double> deformed = F[k] * nodes.tangents[k];
    if (F[k].determinant() < 0) throw_folded(r.part, "rest");
    const double measure =
        r.part.shell() ? deformed.col(0).cross(deformed.col(1)).norm() : std::abs(deformed.determinant());
    masses[static_cast<Eigen::Index>(k)] = measure * u.weight * v[k].weight * w.weight;
  }
  if (r.distribution == nullptr) return masses;
  std::vector<Material<double>> points;
  for (const AngleNode& at : v) points.push_back(material_at(r, u, at, w));
  return masses.cwiseProduct(mass_multiples(r.part, *r.distribution, points));
}

/// Returns the coordinates (columns) in which displacements are affine along a ring. For Follows::ring the
/// coordinates are (C_v^eps, S_v^eps) with the exponent eps of the ring; otherwise they are (x, y).
Eigen::Matrix2Xd ring_coordinates(const RestShape& r, const std::vector<AngleNode>& v,
                                  const RingTangents& nodes) {
  if (r.follows != Follows::ring) return nodes.e.topRows<2>();
  const double ring_exponent = r.part.shape().ring_exponent(r.a);
  Eigen::Matrix2Xd p(2, nodes.e.cols());
  for (std::size_t k = 0; k < v.size(); ++k)
    p.col(static_cast<Eigen::Index>(k)) << signed_power(drop(v[k].c), ring_exponent),
        signed_power(drop(v[k].s), ring_exponent);
  return p;
}

/// Appends the points of a ring, one for each node of v, or four mirror images for each node if r.octant.
void add_points_apart(const RestShape& r, const AngleNode& u, const QuadratureNode& w,
                      const std::vector<AngleNode>& v_nodes, const Eigen::VectorXd& masses,
                      std::vector<RestPoint>& out) {
  for (std::size_t k = 0; k < v_nodes.size(); ++k) {
    const double mass = masses[static_cast<Eigen::Index>(k)];
    const Material<double> m = material_at(r, u, v_nodes[k], w);
    if (r.octant)
      for (const MirrorSigns& signs : kImages) out.push_back({mirrored(m, signs), 2 * mass});
    else
      out.push_back({m, mass});
  }
}

}  // namespace

Eigen::MatrixXd ring_moments(const RestShape& r, const AngleNode& u, const QuadratureNode& w,
                             const std::vector<AngleNode>& v) {
  const RingTangents nodes(r, u, w, v);
  const Eigen::ArrayXd m = ring_masses(r, u, w, v, nodes);
  const Eigen::Matrix2Xd p = ring_coordinates(r, v, nodes);
  const Eigen::ArrayXd x = p.row(0), y = p.row(1);
  Eigen::MatrixXd moments(m.size(), 6);
  moments << m, m * x, m * y, m * x * x, m * x * y, m * y * y;
  return moments;
}

void add_ring(const RestShape& r, const AngleNode& u, const QuadratureNode& w,
              const std::vector<AngleNode>& v, std::vector<RestPoint>& out) {
  const RingTangents nodes(r, u, w, v);
  const Eigen::VectorXd masses = ring_masses(r, u, w, v, nodes);
  if (r.points_apart) {
    add_points_apart(r, u, w, v, masses, out);
    return;
  }
  const ShapeInterface& shape = r.part.shape();
  const Eigen::Matrix2Xd p = ring_coordinates(r, v, nodes);
  PlaneMoments ring;
  for (Eigen::Index k = 0; k < masses.size(); ++k) ring.add(masses[k], p(0, k), p(1, k));
  if (ring.m == 0) return;
  for (const Eigen::Vector2d& three : ring.points()) {
    const Material<double> m = r.follows == Follows::ring
                                   ? on_ring(u, w, three, shape.ring_exponent(r.a))
                                   : shape.label({three[0], three[1], nodes.e(2, 0)}, r.a);
    out.push_back({m, ring.m / 3});
  }
}

}  // namespace pliant
