// Laying mass points: section rules in closed form, ring rules by the panels of the shape, then the choice of
// the smallest rule that is exact to rounding (see the header).
#include <pliant/part/mass_points.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <pliant/math/quadrature.h>
#include <pliant/part/sum_inertia.h>

namespace pliant {

namespace {

struct Point {
  Material<double> at;
  double mass;
};

/// Refinement along the directions of a rule.
struct Levels {
  int u = 0, w = 0, v = 0;  // sections use u for zeta
};
constexpr std::array<int, 15> kSizes{3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 224, 320, 448};
/// A rule beyond is of no use: a step would take a tenth of a second.
constexpr int kMostPoints = 2'000'000;
constexpr int kLastLevel = static_cast<int>(kSizes.size()) - 3;
int size_at(int level) {
  return kSizes[static_cast<std::size_t>(std::min<int>(level, static_cast<int>(kSizes.size()) - 1))];
}

struct Request {
  const Part& part;
  ParameterValues<double> rest;
  const double* a;
  Follows follows;
  bool dynamic_exponents;
};

/// How material points follow the dynamic parameters, the chain considered.
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
  // A shear after a bend reads z too: affine of an affine section is affine, so it may stay.
  return worst;
}

bool has_dynamic_exponent(const Part& part) {
  for (int i : part.parameters().dynamic())
    if (part.parameters()[i].spec->name[0] == 'e') return true;
  return false;
}

[[noreturn]] void folds(const Part& part) {
  throw std::invalid_argument(
      "part '" + part.name() +
      "': its rest shape folds over (the deformation turns some of the solid inside out); "
      "reduce the bend or the taper, or make the body slimmer");
}

[[noreturn]] void too_many_points(const Part& part) {
  std::string names;
  for (int i : part.parameters().dynamic()) names += (names.empty() ? "" : ", ") + part.parameters()[i].name;
  throw std::invalid_argument("part '" + part.name() + "': its mass matrix needs more than " +
                              std::to_string(kMostPoints) + " mass points to be exact for all of " + names +
                              "; narrow the limits of some of them (min, max), or freeze them");
}

/// Refuses a rest shape of which some of the surface is turned inside out: sections and rings do not see
/// their own rims.
void refuse_folds(const Request& r) {
  if (r.part.parameters().links().empty()) return;
  constexpr int round = 32;
  const int tall = r.part.shape().mesh() == MeshPattern::torus ? round / 2 : round / 4;
  Eigen::Matrix3Xd e(3, (2 * tall + 1) * round);
  Eigen::Index column = 0;
  for (int i = -tall; i <= tall; ++i)
    for (int j = 0; j < round; ++j)
      e.col(column++) = r.part.shape().e(material_at(2 * kPi * i / round, 2 * kPi * j / round), r.a);
  for (const Mat3<double>& F : r.part.chain_gradient(e, r.rest))
    if (F.determinant() < -1e-12) folds(r.part);
}

/// Centre and spread of masses in a plane, as three points of equal mass.
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

std::vector<Point> section_points(const Request& r, int level) {
  const ShapeFace& shape = r.part.shape();
  const double h = shape.half_height(r.a);
  struct Slice {
    double z, volume;
    Section section;
  };
  std::vector<Slice> slices;
  for (const SectionPanel& panel : shape.section_panels(r.a)) {
    const double extent = panel.to - panel.from;
    for (const QuadratureNode& node :
         panel.singular ? both_ends_rule(size_at(level)) : gauss_rule(size_at(level))) {
      const double zeta = panel.from + extent * node.x;
      const double gap = zeta < 0 ? (panel.from + 1) + extent * node.x : (1 - panel.to) + extent * node.gap;
      const Section section = shape.section(zeta, gap, r.a);
      if (section.area > 0) slices.push_back({zeta * h, section.area * h * extent * node.weight, section});
    }
  }
  // The determinant of the chain is affine in (x, y) on each section: three samples.
  Eigen::Matrix3Xd samples(3, 3 * static_cast<Eigen::Index>(slices.size()));
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(3 * i);
    const Slice& s = slices[i];
    samples.col(at) << 0, 0, s.z;
    samples.col(at + 1) << std::sqrt(s.section.xx), 0, s.z;
    samples.col(at + 2) << 0, std::sqrt(s.section.yy), s.z;
  }
  const std::vector<Mat3<double>> F = r.part.chain_gradient(samples, r.rest);
  std::vector<Point> points;
  for (std::size_t i = 0; i < slices.size(); ++i) {
    const Slice& s = slices[i];
    const double d0 = F[3 * i].determinant();
    const double dx = F[3 * i + 1].determinant() - d0, dy = F[3 * i + 2].determinant() - d0;
    if (!(d0 > 0)) {
      if (d0 == 0) continue;  // the tip of a full taper carries nothing
      folds(r.part);
    }
    const double m = s.volume;
    PlaneMoments moments;
    moments.m = m * d0;
    moments.x = m * dx * std::sqrt(s.section.xx);
    moments.y = m * dy * std::sqrt(s.section.yy);
    moments.xx = m * d0 * s.section.xx;
    moments.yy = m * d0 * s.section.yy;
    for (const Eigen::Vector2d& p : moments.points())
      points.push_back({shape.label({p[0], p[1], s.z}, r.a), moments.m / 3});
  }
  return points;
}

/// A node along one angle: its cosine and sine with their derivatives by the variable of the rule.
struct AngleNode {
  Trig<Dual<1>> c, s;
  double weight;
};

/// By its logarithm, whose slope stays finite where the value underflows.
Trig<Dual<1>> from_log(double log_abs, double log_slope, double sign) {
  const double value = sign * std::exp(log_abs);
  Trig<Dual<1>> t{Dual<1>(value), Dual<1>(sign), Dual<1>(log_abs)};
  t.x.d[0] = value * log_slope;
  t.log_abs.d[0] = log_slope;
  return t;
}
Trig<Dual<1>> with_slope(double value, double slope) {
  const Trig<double> t = trig(value);
  Trig<Dual<1>> r{Dual<1>(value), Dual<1>(t.sign), Dual<1>(t.log_abs)};
  r.x.d[0] = slope;
  r.log_abs.d[0] = value != 0 ? slope / value : 0;
  return r;
}

/// moving: exponents are dynamic, so that no power of the variable stays what it is.
std::vector<AngleNode> angle_nodes(const std::vector<Panel>& panels, int level, bool moving) {
  std::vector<AngleNode> nodes;
  const int n = size_at(level);
  for (const Panel& panel : panels) {
    if (panel.kind == Panel::Kind::periodic) {
      const int m = 2 * n;
      for (int i = 0; i < m; ++i) {
        const double angle = panel.from + (panel.to - panel.from) * (i + 0.5) / m;
        const double c = std::cos(angle), s = std::sin(angle);
        nodes.push_back({with_slope(c, -s), with_slope(s, c), (panel.to - panel.from) / m});
      }
    } else if (panel.kind == Panel::Kind::smooth) {
      for (const QuadratureNode& node : gauss_rule(n)) {
        const double angle = panel.from + (panel.to - panel.from) * node.x;
        const double c = std::cos(angle), s = std::sin(angle);
        nodes.push_back({with_slope(c, -s), with_slope(s, c), (panel.to - panel.from) * node.weight});
      }
    } else {
      // Variable t = |near|^eps in [0, 2^(-eps/2)], near the sine or the cosine that vanishes at the axis.
      // There a fixed exponent leaves powers of t^(2/eps): t = x^q with q a multiple of eps makes them
      // smooth.
      const double q = moving ? 4 : panel.eps * std::ceil(3 / panel.eps);
      const double top = std::exp2(-panel.eps / 2);
      auto add = [&](double log_near, double weight) {
        const double near2 = std::exp(2 * log_near), far2 = -std::expm1(2 * log_near);
        const double log_near_slope = std::exp(-panel.eps * log_near) / panel.eps;  // 1 / (eps t)
        const double log_far_slope = -near2 * log_near_slope / far2;
        const double sign_near = panel.along_sin ? panel.sign_sin : panel.sign_cos;
        const double sign_far = panel.along_sin ? panel.sign_cos : panel.sign_sin;
        const Trig<Dual<1>> a = from_log(log_near, log_near_slope, sign_near);
        const Trig<Dual<1>> b = from_log(0.5 * std::log(far2), log_far_slope, sign_far);
        nodes.push_back(panel.along_sin ? AngleNode{b, a, weight} : AngleNode{a, b, weight});
      };
      double reach = top;
      if (panel.eps < 0.25) {
        // All that happens does so next to the corner, where log near is the good variable; below e^-16 the
        // far side does not change any more.
        const double from = std::log(std::sqrt(0.5)), to = -16;
        for (const QuadratureNode& node : gauss_rule(n)) {
          const double log_near = from + (to - from) * node.x;
          add(log_near, panel.eps * std::exp(panel.eps * log_near) * (from - to) * node.weight);
        }
        reach = std::exp(panel.eps * to);
      }
      for (const QuadratureNode& node : one_end_rule(n, q))
        add(std::log(reach * node.x) / panel.eps, reach * node.weight);
    }
  }
  return nodes;
}

Trig<Dual<3>> lift(const Trig<Dual<1>>& t, std::size_t slot) {
  Trig<Dual<3>> r{Dual<3>(t.x.v), Dual<3>(t.sign.v), Dual<3>(t.log_abs.v)};
  r.x.d[slot] = t.x.d[0];
  r.log_abs.d[slot] = t.log_abs.d[0];
  return r;
}
Trig<double> drop(const Trig<Dual<1>>& t) {
  return {t.x.v, t.sign.v, t.log_abs.v};
}

std::vector<Point> ring_points(const Request& r, const Levels& levels) {
  const ShapeFace& shape = r.part.shape();
  const std::vector<AngleNode> u_nodes =
      angle_nodes(shape.profile(r.a, r.dynamic_exponents), levels.u, r.dynamic_exponents);
  const std::vector<AngleNode> v_nodes =
      angle_nodes(shape.ring(r.a, r.dynamic_exponents), levels.v, r.dynamic_exponents);
  std::vector<QuadratureNode> w_nodes{{1, 0, 1}};
  if (!r.part.shell()) w_nodes = gauss_rule(size_at(levels.w));
  const double ring_exponent = shape.ring_exponent(r.a);

  std::vector<Point> points;
  Eigen::Matrix3Xd e(3, static_cast<Eigen::Index>(v_nodes.size()));
  std::vector<Mat3<double>> tangents(v_nodes.size());
  for (const AngleNode& u : u_nodes) {
    for (const QuadratureNode& w : w_nodes) {
      for (std::size_t k = 0; k < v_nodes.size(); ++k) {
        const AngleNode& v = v_nodes[k];
        const Material<Dual<3>> m{lift(u.c, 0), lift(u.s, 0), lift(v.c, 1), lift(v.s, 1),
                                  Dual<3>::variable(w.x, 2)};
        const Vec3<Dual<3>> at = shape.rest_tangents(m, r.a);
        for (int i = 0; i < 3; ++i) {
          e(i, static_cast<Eigen::Index>(k)) = at[i].v;
          for (int j = 0; j < 3; ++j) tangents[k](i, j) = at[i].d[static_cast<std::size_t>(j)];
        }
      }
      const std::vector<Mat3<double>> F = r.part.chain_gradient(e, r.rest);
      // Rings of a shape of one's own need not be plane; then no three points stand for one.
      const bool plane = e.row(2).maxCoeff() - e.row(2).minCoeff() <= 1e-12 * r.part.size();
      const bool apart = r.follows == Follows::free || (r.follows != Follows::ring && !plane);
      PlaneMoments ring;
      for (std::size_t k = 0; k < v_nodes.size(); ++k) {
        const AngleNode& v = v_nodes[k];
        const Mat3<double> now = F[k] * tangents[k];
        if (F[k].determinant() < 0) folds(r.part);
        const double measure =
            r.part.shell() ? now.col(0).cross(now.col(1)).norm() : std::abs(now.determinant());
        const double mass = measure * u.weight * v.weight * w.weight;
        if (mass == 0) continue;
        const auto column = static_cast<Eigen::Index>(k);
        if (apart) {
          const Material<double> m{drop(u.c), drop(u.s), drop(v.c), drop(v.s), w.x};
          points.push_back({shape.from_rest_map(m, r.a), mass});
        } else if (r.follows == Follows::ring) {
          ring.add(mass, signed_power(drop(v.c), ring_exponent), signed_power(drop(v.s), ring_exponent));
        } else {
          ring.add(mass, e(0, column), e(1, column));
        }
      }
      if (apart || ring.m == 0) continue;
      for (const Eigen::Vector2d& p : ring.points()) {
        Material<double> m;
        if (r.follows == Follows::ring) {
          auto coordinate = [&](double x) {
            Trig<double> t = trig(x);
            if (x != 0) t.log_abs /= ring_exponent;
            return t;
          };
          m = {drop(u.c), drop(u.s), coordinate(p[0]), coordinate(p[1]), w.x};
        } else {
          m = shape.label({p[0], p[1], e(2, 0)}, r.a);
        }
        points.push_back({m, ring.m / 3});
      }
    }
  }
  return points;
}

/// The same mass, centroid and second moments on four points.
std::vector<Point> affine_points(const Request& r, const std::vector<Point>& points) {
  const ShapeFace& shape = r.part.shape();
  double m = 0;
  Vec3<double> first = Vec3<double>::Zero();
  Mat3<double> second = Mat3<double>::Zero();
  for (const Point& p : points) {
    const Vec3<double> e = shape.e(p.at, r.a);
    m += p.mass;
    first += p.mass * e;
    second += p.mass * e * e.transpose();
  }
  const Vec3<double> centre = first / m;
  const Mat3<double> L = Mat3<double>(second / m - centre * centre.transpose()).llt().matrixL();
  std::vector<Point> four;
  for (int k = 0; k < 4; ++k) {
    const Vec3<double> corner(k < 2 ? 1 : -1, k % 2 == 0 ? 1 : -1, k == 0 || k == 3 ? 1 : -1);
    four.push_back({shape.label(centre + L * corner, r.a), m / 4});
  }
  return four;
}

MassPoints packed(const std::vector<Point>& points, double density, const char* rule) {
  MassPoints out;
  out.rule = rule;
  out.n_points = static_cast<int>(points.size());
  for (std::size_t first = 0; first < points.size(); first += Pack::kLanes) {
    std::array<Material<double>, Pack::kLanes> four;
    Pack mass(0.0);
    for (std::size_t i = 0; i < Pack::kLanes; ++i) {
      const std::size_t k = first + i;
      four[i] = points[std::min(k, points.size() - 1)].at;
      if (k < points.size()) mass.set(static_cast<int>(i), density * points[k].mass);
    }
    out.at.push_back(gather(four.data()));
    out.mass.push_back(mass);
  }
  return out;
}

bool by_sections(const Request& r) {
  return !r.part.shell() && r.follows <= Follows::section && r.part.shape().has_sections();
}

MassPoints lay(const Request& r, const Levels& levels) {
  const double density = r.part.density();
  if (by_sections(r)) {
    const std::vector<Point> points = section_points(r, levels.u);
    if (r.follows == Follows::affine) return packed(affine_points(r, points), density, "affine");
    return packed(points, density, "sections");
  }
  const std::vector<Point> points = ring_points(r, levels);
  if (r.follows == Follows::affine) return packed(affine_points(r, points), density, "affine");
  return packed(points, density, r.follows == Follows::free ? "full" : "rings");
}

/// States at which rules are compared: rest, the ends of the ranges, and mixtures.
struct Probe {
  VecMax<double> q_s, q_s_dot;
};
std::vector<Probe> probes(const Part& part) {
  const Parameters& all = part.parameters();
  const int n = all.n_dynamic();
  std::vector<Probe> states;
  std::uint64_t seed = 0x9e3779b97f4a7c15u;
  auto uniform = [&seed] {  // xorshift: the same everywhere
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return static_cast<double>(seed >> 11) * 0x1.0p-53;
  };
  for (int k = 0; k < (n > 0 ? 5 : 1); ++k) {
    Probe probe{VecMax<double>(n), VecMax<double>(n)};
    for (int i = 0; i < n; ++i) {
      const Parameter& p = all[all.dynamic()[static_cast<std::size_t>(i)]];
      const double rest = p.rest_value();
      // Lengths scale the body: from half to twice their rest value tells all; offsets up to twice its size.
      const bool offset = !p.spec->relative && p.spec->unit[0] == 'm';
      const double scale = p.spec->relative ? rest : (offset ? part.size() : 1.0);
      const double reach = offset ? 2 * scale : kInfinity;
      const double low = std::max({p.limits.min, p.spec->relative ? 0.5 * rest : -kInfinity, -reach});
      const double high = std::min({p.limits.max, p.spec->relative ? 2 * rest : kInfinity, reach});
      const double mix = k == 0 ? 0 : (k == 1 ? 1.0 : (k == 2 ? 0.0 : uniform()));
      probe.q_s[i] = k == 0 ? rest : low + mix * (high - low);
      probe.q_s_dot[i] = scale * (0.5 + uniform());
    }
    states.push_back(probe);
  }
  return states;
}

struct Judge {
  const Part& part;
  std::vector<Probe> states;

  std::vector<Inertia<double>> measure(const MassPoints& points) const {
    std::vector<Inertia<double>> all(states.size());
    Counters unused;
    for (std::size_t i = 0; i < states.size(); ++i)
      sum_inertia(part, points, states[i].q_s, states[i].q_s_dot, {0.7, -0.4, 1.1}, all[i], unused);
    return all;
  }
  /// The largest difference, each entry relative to its scale.
  static double difference(const std::vector<Inertia<double>>& a, const std::vector<Inertia<double>>& b) {
    double worst = 0;
    for (std::size_t k = 0; k < a.size(); ++k) {
      const auto& M = b[k].M;
      const VecMax<double> scale = M.diagonal().cwiseSqrt();
      double force = 0;
      for (Eigen::Index i = 0; i < scale.size(); ++i)
        if (scale[i] > 0) force = std::max(force, std::abs(b[k].g_q[i]) / scale[i]);
      for (Eigen::Index i = 0; i < scale.size(); ++i) {
        if (!(scale[i] > 0)) continue;
        worst = std::max(worst, std::abs(a[k].g_q[i] - b[k].g_q[i]) / (scale[i] * force));
        for (Eigen::Index j = 0; j <= i; ++j)
          if (scale[j] > 0) worst = std::max(worst, std::abs(a[k].M(i, j) - M(i, j)) / (scale[i] * scale[j]));
      }
    }
    return worst;
  }
};

}  // namespace

MassPoints lay_mass_points(const Part& part, int extra_level) {
  const ParameterValues<double> rest = part.parameters().rest();
  const Request request{part, rest, rest.b.data(), follows(part), has_dynamic_exponent(part)};
  const Judge judge{part, probes(part)};
  double tolerance = 1e-13;
  constexpr double most_rounding = 1e-12;
  refuse_folds(request);

  Levels levels;
  MassPoints points = lay(request, levels);
  std::vector<Inertia<double>> now = judge.measure(points);
  const bool sections = by_sections(request);
  for (bool settled = false; !settled;) {
    settled = true;
    for (int Levels::*direction : {&Levels::u, &Levels::w, &Levels::v}) {
      if (direction != &Levels::u && sections) continue;
      if (direction == &Levels::w && part.shell()) continue;
      double last = kInfinity;
      while (levels.*direction < kLastLevel) {
        Levels finer = levels;
        finer.*direction += 2;
        const double difference = Judge::difference(now, judge.measure(lay(request, finer)));
        // Sums over many points keep a rounding of their own, which no finer rule takes away.
        if (difference <= most_rounding && difference >= last)
          tolerance = std::max(tolerance, 2 * difference);
        if (difference <= tolerance) break;
        if (points.n_points > kMostPoints) too_many_points(part);
        last = difference;
        ++(levels.*direction);
        points = lay(request, levels);
        now = judge.measure(points);
        settled = false;
      }
    }
  }
  if (extra_level > 0) {
    Levels finer = levels;
    for (int Levels::*direction : {&Levels::u, &Levels::w, &Levels::v}) finer.*direction += 2 * extra_level;
    points = lay(request, finer);
  }
  points.level = levels.u;
  return points;
}

}  // namespace pliant
