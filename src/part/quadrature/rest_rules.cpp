// Points of plane sections and of material rings at rest.
#include "rest_rules.h"

#include <algorithm>
#include <array>
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
  // A shear after a bend depends on z too. The shear maps a tilted plane section affinely to a plane section,
  // so that the result is not Follows::free.
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

/// Returns a sine or cosine from the logarithm of its absolute value, the derivative of this logarithm, and
/// the sign. The derivative of the logarithm is finite where the value underflows.
Trig<Dual<1>> from_log(double log_abs, double log_slope, double sign) {
  const double value = sign * std::exp(log_abs);
  Trig<Dual<1>> t{Dual<1>(value), Dual<1>(sign), Dual<1>(log_abs)};
  t.x.d[0] = value * log_slope;
  t.log_abs.d[0] = log_slope;
  return t;
}
/// Returns a sine or cosine with its derivative.
Trig<Dual<1>> with_slope(double value, double slope) {
  const Trig<double> t = trig(value);
  Trig<Dual<1>> r{Dual<1>(value), Dual<1>(t.sign), Dual<1>(t.log_abs)};
  r.x.d[0] = slope;
  r.log_abs.d[0] = value != 0 ? slope / value : 0;
  return r;
}

/// Adds m equidistant nodes of a periodic panel to `nodes`.
void add_periodic_nodes(const Panel& panel, int m, std::vector<AngleNode>& nodes) {
  for (int i = 0; i < m; ++i) {
    const double angle = panel.from + (panel.to - panel.from) * (i + 0.5) / m;
    const double c = std::cos(angle), s = std::sin(angle);
    nodes.push_back({with_slope(c, -s), with_slope(s, c), (panel.to - panel.from) / m});
  }
}

/// Adds n Gauss nodes of a panel on which the shape is smooth in the angle to `nodes`.
void add_smooth_nodes(const Panel& panel, int n, std::vector<AngleNode>& nodes) {
  for (const QuadratureNode& node : gauss_rule(n)) {
    const double angle = panel.from + (panel.to - panel.from) * node.x;
    const double c = std::cos(angle), s = std::sin(angle);
    nodes.push_back({with_slope(c, -s), with_slope(s, c), (panel.to - panel.from) * node.weight});
  }
}

/// A panel from a coordinate axis to 45 degrees, with the variable t = |near|^eps in [0, 2^(-eps/2)]. `near`
/// is the sine or cosine that vanishes at the axis, and `far` is the other function.
class PowerPanel {
 public:
  PowerPanel(const Panel& panel, std::vector<AngleNode>& nodes) : panel_(panel), nodes_(nodes) {}

  /// Adds n nodes for dynamic exponents. Powers t^p with many different p are exponentials in y = -log near
  /// with many decay rates. The nodes are dense near 45 degrees, where y is smallest. The smallest t is about
  /// e^-37, which is rounding relative to 1.
  void add_for_all_powers(int n) {
    const double reach = 37 / panel_.eps;
    for (const QuadratureNode& node : one_end_rule(n, 3)) {
      const double log_near = kMiddle - reach * node.x;
      add(log_near, panel_.eps * std::exp(panel_.eps * log_near) * reach * node.weight);
    }
  }
  /// Adds nodes for a fixed exponent: n nodes, or 2 n if eps is below 0.25. The integrand consists of powers
  /// of t^(2/eps); with t = x^q and q a multiple of eps, these powers are smooth in x.
  void add_for_fixed_power(int n) {
    double reach = std::exp2(-panel_.eps / 2);
    if (panel_.eps < 0.25) {
      // The superellipse is nearly a square, and the integrand varies only next to the corner at 45 degrees,
      // where log near is the suitable variable. For near < e^-16, far is 1 to within rounding.
      const double to = -16;
      for (const QuadratureNode& node : gauss_rule(n)) {
        const double log_near = kMiddle + (to - kMiddle) * node.x;
        add(log_near, panel_.eps * std::exp(panel_.eps * log_near) * (kMiddle - to) * node.weight);
      }
      reach = std::exp(panel_.eps * to);
    }
    for (const QuadratureNode& node : one_end_rule(n, panel_.eps * std::ceil(3 / panel_.eps)))
      add(std::log(reach * node.x) / panel_.eps, reach * node.weight);
  }

 private:
  void add(double log_near, double weight) {
    const double near2 = std::exp(2 * log_near), far2 = -std::expm1(2 * log_near);
    const double log_near_slope = std::exp(-panel_.eps * log_near) / panel_.eps;  // 1 / (eps t)
    const double log_far_slope = -near2 * log_near_slope / far2;
    const double sign_near = panel_.along_sin ? panel_.sign_sin : panel_.sign_cos;
    const double sign_far = panel_.along_sin ? panel_.sign_cos : panel_.sign_sin;
    const Trig<Dual<1>> near = from_log(log_near, log_near_slope, sign_near);
    const Trig<Dual<1>> far = from_log(0.5 * std::log(far2), log_far_slope, sign_far);
    nodes_.push_back(panel_.along_sin ? AngleNode{far, near, weight} : AngleNode{near, far, weight});
  }

  const double kMiddle = std::log(std::sqrt(0.5));  // log near at 45 degrees
  const Panel& panel_;
  std::vector<AngleNode>& nodes_;
};

/// Returns the nodes of panels: n in each panel, but 2 n in a periodic panel and in a power panel with a
/// fixed exponent below 0.25. dynamic_exponents: whether an exponent is a degree of freedom.
std::vector<AngleNode> angle_nodes(const std::vector<Panel>& panels, int n, bool dynamic_exponents) {
  std::vector<AngleNode> nodes;
  for (const Panel& panel : panels) {
    if (panel.kind == Panel::Kind::periodic)
      add_periodic_nodes(panel, 2 * n, nodes);
    else if (panel.kind == Panel::Kind::smooth)
      add_smooth_nodes(panel, n, nodes);
    else if (dynamic_exponents)
      PowerPanel(panel, nodes).add_for_all_powers(n);
    else
      PowerPanel(panel, nodes).add_for_fixed_power(n);
  }
  return nodes;
}

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

RestShape::RestShape(const Part& whole)
    : part(whole),
      rest(whole.parameters().rest()),
      a(rest.b.data()),
      follows(pliant::follows(whole)),
      dynamic_exponents(has_dynamic_exponent(whole)) {
  by_sections = !part.shell() && follows <= Follows::section && part.shape().has_sections();
  points_apart =
      follows == Follows::free || (!by_sections && follows != Follows::ring && !plane_rings(*this));
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

std::vector<AngleNode> profile_nodes(const RestShape& r, int n) {
  return angle_nodes(r.part.shape().profile(r.a, r.dynamic_exponents), n, r.dynamic_exponents);
}
std::vector<AngleNode> ring_nodes(const RestShape& r, int n) {
  return angle_nodes(r.part.shape().ring(r.a, r.dynamic_exponents), n, r.dynamic_exponents);
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

}  // namespace

void add_ring(const RestShape& r, const AngleNode& u, const QuadratureNode& w,
              const std::vector<AngleNode>& v_nodes, std::vector<RestPoint>& out) {
  const ShapeInterface& shape = r.part.shape();
  const double ring_exponent = shape.ring_exponent(r.a);
  const RingTangents nodes(r, u, w, v_nodes);
  const std::vector<Mat3<double>> F = r.part.chain_gradient(nodes.e, r.rest);
  PlaneMoments ring;
  for (std::size_t k = 0; k < v_nodes.size(); ++k) {
    const AngleNode& v = v_nodes[k];
    const Mat3<double> deformed = F[k] * nodes.tangents[k];
    if (F[k].determinant() < 0) throw_folded(r.part, "rest");
    const double measure =
        r.part.shell() ? deformed.col(0).cross(deformed.col(1)).norm() : std::abs(deformed.determinant());
    const double mass = measure * u.weight * v.weight * w.weight;
    const auto column = static_cast<Eigen::Index>(k);
    if (r.points_apart) {
      const Material<double> m{drop(u.c), drop(u.s), drop(v.c), drop(v.s), w.x};
      out.push_back({shape.from_rest_map(m, r.a), mass});
    } else if (r.follows == Follows::ring) {
      ring.add(mass, signed_power(drop(v.c), ring_exponent), signed_power(drop(v.s), ring_exponent));
    } else {
      ring.add(mass, nodes.e(0, column), nodes.e(1, column));
    }
  }
  if (r.points_apart || ring.m == 0) return;
  for (const Eigen::Vector2d& p : ring.points()) {
    const Material<double> m = r.follows == Follows::ring ? on_ring(u, w, p, ring_exponent)
                                                          : shape.label({p[0], p[1], nodes.e(2, 0)}, r.a);
    out.push_back({m, ring.m / 3});
  }
}

}  // namespace pliant
