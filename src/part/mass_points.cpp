// Laying mass points: along each direction of the rest shape, nodes are refined until no integral of the
// dynamics changes, then thinned to as few as give the same integrals. Both are judged by the integrands of M
// and g_q at states spread over the ranges of the dynamic parameters, at places spread over the other
// directions.
#include <pliant/part/mass_points.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include <pliant/math/thin_rule.h>

#include "rest_rules.h"

namespace pliant {

namespace {

/// Nodes a panel, by level of refinement; two levels double them.
constexpr std::array<int, 15> kSizes{3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 224, 320, 448};
constexpr int kLastLevel = static_cast<int>(kSizes.size()) - 3;
int size_at(int level) {
  return kSizes[static_cast<std::size_t>(std::min<int>(level, static_cast<int>(kSizes.size()) - 1))];
}

/// xorshift: the same everywhere.
class Draw {
 public:
  double uniform() {
    seed_ ^= seed_ << 13;
    seed_ ^= seed_ >> 7;
    seed_ ^= seed_ << 17;
    return static_cast<double>(seed_ >> 11) * 0x1.0p-53;
  }
  double either_way() { return 2 * uniform() - 1; }
  std::size_t below(std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(uniform() * static_cast<double>(n)));
  }

 private:
  std::uint64_t seed_ = 0x9e3779b97f4a7c15u;
};

/// The points of the nodes of one direction, at one place of the other directions.
struct Column {
  std::vector<RestPoint> points;
  std::vector<Eigen::Index> node;  ///< of each point
  void end_node(Eigen::Index which) { node.resize(points.size(), which); }
};
struct Columns {
  std::vector<Column> columns;
  Eigen::Index n_nodes = 0;
};

struct Packed {
  std::vector<Material<Pack>> at;
  std::vector<Pack> mass;
};
Packed pack(const std::vector<RestPoint>& points, double density) {
  Packed out;
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

/// Integrands of the mass matrix and of the inertial forces: (La).(Lb) and (La).(acceleration at vdot = 0),
/// for random combinations a, b of generalised velocities at random states.
class Integrands {
 public:
  static constexpr int kEach = 3;  ///< functions a state

  explicit Integrands(const RestShape& shape) : shape_(shape) {
    const Parameters& all = shape.part.parameters();
    for (int i : all.dynamic()) {
      const Parameter& p = all[i];
      const double rest = p.rest_value();
      // Lengths scale the body: from half to twice their rest value tells all; offsets up to twice its size.
      const bool offset = !p.spec->relative && p.spec->quantity == Quantity::length;
      const double scale =
          p.spec->relative ? rest : (offset ? shape.part.size() : std::max(1.0, std::abs(rest)));
      const double reach = offset ? 2 * scale : kInfinity;
      // So do numbers that range over orders of magnitude.
      const bool wide = p.spec->relative || p.limits.max > 100 * scale;
      ranges_.push_back({std::max({p.limits.min, wide ? 0.5 * rest : -kInfinity, -reach}),
                         std::min({p.limits.max, wide ? 2 * rest : kInfinity, reach}), rest, scale});
    }
  }
  int n() const { return static_cast<int>(ranges_.size()); }

  /// F(node, function): the shares of the nodes of one direction in each integral.
  Eigen::MatrixXd shares(const Columns& line, int n_states) const {
    Eigen::MatrixXd F = Eigen::MatrixXd::Zero(line.n_nodes, kEach * n_states);
    Draw draw;
    std::vector<Packed> packed;
    for (const Column& column : line.columns) packed.push_back(pack(column.points, 1));
    for (int state = 0; state < n_states; ++state) {
      const std::size_t place = static_cast<std::size_t>(state) % line.columns.size();
      add_state(draw, state, line.columns[place], packed[place], F.middleCols(kEach * state, kEach));
    }
    return F;
  }

 private:
  struct RangeOf {
    double low, high, rest, scale;
  };

  void add_state(Draw& draw, int state, const Column& column, const Packed& packed,
                 Eigen::Ref<Eigen::MatrixXd> F) const {
    VecMax<double> q(n()), rate(n());
    for (int i = 0; i < n(); ++i) {
      const RangeOf& range = ranges_[static_cast<std::size_t>(i)];
      // Every third state at a corner of the ranges, where the integrands are at their worst.
      const double inside = draw.uniform();
      const double mix = state % 3 == 1 ? std::round(inside) : inside;
      q[i] = state == 0 ? range.rest : range.low + mix * (range.high - range.low);
      rate[i] = range.scale * draw.either_way();
    }
    Vec3<double> omega;
    for (int i = 0; i < 3; ++i) omega[i] = draw.either_way();
    Eigen::MatrixXd mix(6 + n(), kEach + 2);
    for (Eigen::Index i = 0; i < mix.size(); ++i) mix.data()[i] = draw.either_way();

    // L of every point, three rows each, and the acceleration.
    const auto count = static_cast<Eigen::Index>(column.points.size());
    if (count == 0) return;
    Eigen::MatrixXd L(3 * count, 6 + n());
    Eigen::VectorXd acceleration(3 * count);
    const ParameterValues<double> values = shape_.part.parameters().expand<double>(q, rate);
    constexpr int block = 8;
    std::array<Jet<Pack>, block> jets;
    for (std::size_t first = 0; first < packed.at.size(); first += block) {
      const int packs = static_cast<int>(std::min<std::size_t>(block, packed.at.size() - first));
      JetBatch<Pack> batch{jets.data(), packs, 0, Level::rates};
      shape_.part.jets(values, packed.at.data() + first, batch);
      for (int lane = 0; lane < packs * static_cast<int>(Pack::kLanes); ++lane) {
        const Eigen::Index point = static_cast<Eigen::Index>(first * Pack::kLanes) + lane;
        if (point >= count) break;
        const Jet<Pack>& jet = jets[static_cast<std::size_t>(lane) / Pack::kLanes];
        const int l = lane % static_cast<int>(Pack::kLanes);
        auto one = [l](const Vec3<Pack>& x) { return Vec3<double>(x[0][l], x[1][l], x[2][l]); };
        const Vec3<double> s = one(jet.s);
        auto rows = L.middleRows<3>(3 * point);
        rows.leftCols<3>().setIdentity();
        for (int i = 0; i < 3; ++i) rows.col(3 + i) = Vec3<double>::Unit(i).cross(s);
        for (int i = 0; i < n(); ++i) rows.col(6 + i) = one(jet.J[static_cast<std::size_t>(i)]);
        acceleration.segment<3>(3 * point) =
            omega.cross(omega.cross(s)) + 2 * omega.cross(one(jet.s1)) + one(jet.s2);
      }
    }
    // Each column in units of its own spread, so that small entries of M count as much as large ones.
    double mass = 0;
    for (const RestPoint& p : column.points) mass += p.mass;
    if (!(mass > 0)) return;
    for (Eigen::Index c = 0; c < L.cols() + 1; ++c) {
      double square = 0;
      auto x =
          c < L.cols() ? Eigen::Ref<Eigen::VectorXd>(L.col(c)) : Eigen::Ref<Eigen::VectorXd>(acceleration);
      for (Eigen::Index k = 0; k < count; ++k)
        square += column.points[static_cast<std::size_t>(k)].mass * x.segment<3>(3 * k).squaredNorm();
      if (square > 0) x *= std::sqrt(mass / square);
    }
    const Eigen::MatrixXd moved = L * mix;
    for (Eigen::Index k = 0; k < count; ++k) {
      const auto index = static_cast<std::size_t>(k);
      const double m = column.points[index].mass;
      const auto at = moved.middleRows<3>(3 * k);
      F(column.node[index], 0) += m * at.col(0).dot(at.col(1));
      F(column.node[index], 1) += m * at.col(2).dot(at.col(3));
      F(column.node[index], 2) += m * at.col(4).dot(acceleration.segment<3>(3 * k));
    }
  }

  const RestShape& shape_;
  std::vector<RangeOf> ranges_;
};

constexpr double kTolerance = 2e-14;
/// What is promised of every rule (design 1.3).
constexpr double kPromised = 1e-12;

/// The smallest level at which doubling changes no integral; columns(level) lays the nodes. Notes the change
/// that is left if the last level does not suffice.
template <class MakeColumns>
int settle(const Integrands& integrands, double& left, const MakeColumns& columns) {
  struct Integrals {
    Eigen::VectorXd value, size;
  };
  const int n_states = integrands.n() == 0 ? 8 : 48;
  std::vector<Integrals> known;
  auto at = [&](int level) -> const Integrals& {
    while (static_cast<int>(known.size()) <= level) {
      const Eigen::MatrixXd F = integrands.shares(columns(static_cast<int>(known.size())), n_states);
      known.push_back({F.colwise().sum(), F.cwiseAbs().colwise().sum()});
    }
    return known[static_cast<std::size_t>(level)];
  };
  double least_change = kInfinity;
  int best = 0;
  for (int level = 0; level <= kLastLevel; ++level) {
    at(level + 2);
    const Integrals &now = at(level), &finer = at(level + 2);
    // A place of little mass matters little.
    const double least = 0.1 * finer.size.mean();
    if (least == 0) return level;
    const double change =
        ((now.value - finer.value).array().abs() / finer.size.array().max(least)).maxCoeff();
    if (change <= kTolerance) return level;
    if (change < 0.5 * least_change) {
      least_change = change;
      best = level;
    }
    // Sums of terms that cancel keep a rounding of their own, which no finer rule takes away.
    if (least_change <= kPromised && level >= best + 2) return best;
  }
  left = std::max(left, least_change);
  return kLastLevel;
}

/// Keeps of the nodes of one direction as many as their integrals need.
template <class Node>
void thin(const Integrands& integrands, const Columns& line, std::vector<Node>& nodes) {
  Eigen::VectorXd factors;
  for (int n_states = 80;; n_states *= 2) {
    Eigen::Index rank = 0;
    factors = thin_rule(integrands.shares(line, n_states), &rank);
    // Functions enough to span what they are drawn from, or no node to spare.
    if (rank <= Integrands::kEach * n_states / 3 || rank >= line.n_nodes) break;
  }
  std::vector<Node> kept;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const double factor = factors[static_cast<Eigen::Index>(i)];
    if (!(factor > 0)) continue;
    kept.push_back(nodes[i]);
    kept.back().weight *= factor;
  }
  nodes = std::move(kept);
}

/// A rule beyond is of no use: a step would take a good part of a second.
constexpr std::size_t kMostPoints = 2'000'000;
[[noreturn]] void too_many_points(const Part& part) {
  std::string names;
  for (int i : part.parameters().dynamic()) names += (names.empty() ? "" : ", ") + part.parameters()[i].name;
  throw std::invalid_argument("part '" + part.name() + "': its mass matrix needs more than " +
                              std::to_string(kMostPoints) + " mass points to be exact for all of " + names +
                              "; narrow the limits of some of them (min, max), or freeze them");
}

ParameterValues<double> initial_values(const Part& part) {
  const Parameters& all = part.parameters();
  VecMax<double> q_s(all.n_dynamic()), still = VecMax<double>::Zero(all.n_dynamic());
  for (int k = 0; k < all.n_dynamic(); ++k) q_s[k] = all.moving(k).initial;
  return all.expand<double>(q_s, still);
}

struct Laid {
  std::vector<RestPoint> points;
  int level = 0;
  double left = 0;
};

Laid lay_slices(const RestShape& shape, const Integrands& integrands, int extra) {
  auto columns = [&](const std::vector<SliceNode>& nodes) {
    Columns line{{Column{}}, 0};
    for (const SliceNode& node : nodes) {
      add_slice(shape, node, line.columns[0].points);
      line.columns[0].end_node(line.n_nodes++);
    }
    return line;
  };
  Laid laid;
  laid.level =
      settle(integrands, laid.left, [&](int level) { return columns(slice_nodes(shape, size_at(level))); });
  std::vector<SliceNode> nodes = slice_nodes(shape, size_at(laid.level + extra));
  if (shape.follows != Follows::affine) thin(integrands, columns(nodes), nodes);
  for (const SliceNode& node : nodes) add_slice(shape, node, laid.points);
  return laid;
}

/// Thinning takes time that grows with the cube of the nodes: more take longer than most runs would save.
constexpr std::size_t kMostThinned = 600;

/// A ring of material points.
struct RingNode {
  AngleNode u;
  QuadratureNode w;
  double weight = 1;  ///< on top of those of u and w
};
void add_ring(const RestShape& shape, const RingNode& ring, const std::vector<AngleNode>& v,
              std::vector<RestPoint>& out) {
  QuadratureNode w = ring.w;
  w.weight *= ring.weight;
  add_ring(shape, ring.u, w, v, out);
}

Laid lay_rings(const RestShape& shape, const Integrands& integrands, int extra) {
  constexpr int coarse = 5, n_places = 16;
  std::vector<AngleNode> u = profile_nodes(shape, coarse), v = ring_nodes(shape, coarse);
  std::vector<QuadratureNode> w = depth_nodes(shape, coarse);
  const std::size_t no_place = 0;

  // Nodes of one direction at places of the others; where points of a ring do not move apart the ring goes
  // along.
  auto along_v = [&](const std::vector<AngleNode>& nodes) {
    Columns line;
    Draw draw;
    for (int k = 0; k < n_places; ++k) {
      Column column;
      add_ring(shape, u[draw.below(u.size())], w[draw.below(w.size())], nodes, column.points);
      for (std::size_t i = 0; i < column.points.size(); ++i)
        column.node.push_back(shape.points_apart ? static_cast<Eigen::Index>(i) : 0);
      line.columns.push_back(std::move(column));
    }
    line.n_nodes = shape.points_apart ? static_cast<Eigen::Index>(nodes.size()) : 1;
    return line;
  };
  auto ring_at = [&](std::size_t place) { return shape.points_apart ? std::vector<AngleNode>{v[place]} : v; };
  auto along_w = [&](const std::vector<QuadratureNode>& nodes) {
    Columns line;
    Draw draw;
    for (int k = 0; k < n_places; ++k) {
      Column column;
      const AngleNode& at = u[draw.below(u.size())];
      const std::vector<AngleNode> ring = ring_at(shape.points_apart ? draw.below(v.size()) : no_place);
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        add_ring(shape, at, nodes[i], ring, column.points);
        column.end_node(static_cast<Eigen::Index>(i));
      }
      line.columns.push_back(std::move(column));
    }
    line.n_nodes = static_cast<Eigen::Index>(nodes.size());
    return line;
  };
  auto along_u = [&](const std::vector<AngleNode>& nodes) {
    Columns line;
    Draw draw;
    const int places = !shape.points_apart && w.size() == 1 ? 1 : n_places;
    for (int k = 0; k < places; ++k) {
      Column column;
      const QuadratureNode& at = w[draw.below(w.size())];
      const std::vector<AngleNode> ring = ring_at(shape.points_apart ? draw.below(v.size()) : no_place);
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        add_ring(shape, nodes[i], at, ring, column.points);
        column.end_node(static_cast<Eigen::Index>(i));
      }
      line.columns.push_back(std::move(column));
    }
    line.n_nodes = static_cast<Eigen::Index>(nodes.size());
    return line;
  };

  Laid laid;
  const bool thinned = shape.follows != Follows::affine;
  int level = settle(integrands, laid.left, [&](int l) { return along_v(ring_nodes(shape, size_at(l))); });
  v = ring_nodes(shape, size_at(level + extra));
  if (shape.points_apart) thin(integrands, along_v(v), v);
  if (!shape.part.shell()) {
    level = settle(integrands, laid.left, [&](int l) { return along_w(depth_nodes(shape, size_at(l))); });
    w = depth_nodes(shape, size_at(level + extra));
    if (thinned) thin(integrands, along_w(w), w);
  }
  laid.level =
      settle(integrands, laid.left, [&](int l) { return along_u(profile_nodes(shape, size_at(l))); });
  u = profile_nodes(shape, size_at(laid.level + extra));
  if (thinned) thin(integrands, along_u(u), u);

  // Rings that differ in u and w together need fewer than all pairs of the two.
  std::vector<RingNode> rings;
  for (const AngleNode& at : u)
    for (const QuadratureNode& depth : w) rings.push_back({at, depth});
  auto along_rings = [&](const std::vector<RingNode>& nodes) {
    Columns line;
    Draw draw;
    for (int k = 0; k < (shape.points_apart ? n_places : 1); ++k) {
      Column column;
      const std::vector<AngleNode> ring = ring_at(shape.points_apart ? draw.below(v.size()) : no_place);
      for (std::size_t i = 0; i < nodes.size(); ++i) {
        add_ring(shape, nodes[i], ring, column.points);
        column.end_node(static_cast<Eigen::Index>(i));
      }
      line.columns.push_back(std::move(column));
    }
    line.n_nodes = static_cast<Eigen::Index>(nodes.size());
    return line;
  };
  if (thinned && w.size() > 1 && rings.size() <= kMostThinned) thin(integrands, along_rings(rings), rings);

  const std::size_t n_points = rings.size() * (shape.points_apart ? v.size() : 3);
  if (n_points > kMostPoints) too_many_points(shape.part);
  for (const RingNode& ring : rings) add_ring(shape, ring, v, laid.points);
  return laid;
}

/// The same mass, centroid and second moments on four points.
std::vector<RestPoint> affine_points(const RestShape& r, const std::vector<RestPoint>& points) {
  const ShapeFace& shape = r.part.shape();
  double m = 0;
  Vec3<double> first = Vec3<double>::Zero();
  Mat3<double> second = Mat3<double>::Zero();
  for (const RestPoint& p : points) {
    const Vec3<double> e = shape.e(p.at, r.a);
    m += p.mass;
    first += p.mass * e;
    second += p.mass * e * e.transpose();
  }
  // What symmetry makes zero is set to zero: in slender bodies its rounding would couple parameters that are
  // not coupled.
  constexpr double noise = 1e-14;
  Vec3<double> centre = first / m;
  for (int i = 0; i < 3; ++i)
    if (std::abs(centre[i]) <= noise * std::sqrt(second(i, i) / m)) centre[i] = 0;
  Mat3<double> spread = second / m - centre * centre.transpose();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (std::abs(spread(i, j)) <= noise * std::sqrt(spread(i, i) * spread(j, j))) spread(i, j) = 0;
  const Mat3<double> L = spread.llt().matrixL();
  std::vector<RestPoint> four;
  for (int k = 0; k < 4; ++k) {
    const Vec3<double> corner(k < 2 ? 1 : -1, k % 2 == 0 ? 1 : -1, k == 0 || k == 3 ? 1 : -1);
    four.push_back({shape.label(centre + L * corner, r.a), m / 4});
  }
  return four;
}

}  // namespace

MassPoints lay_mass_points(const Part& part, int doublings) {
  const RestShape shape(part);
  refuse_folds(part, shape.rest, "rest");
  if (part.n_s() > 0) refuse_folds(part, initial_values(part), "initial");
  const Integrands integrands(shape);
  Laid laid = shape.by_sections ? lay_slices(shape, integrands, 2 * doublings)
                                : lay_rings(shape, integrands, 2 * doublings);
  const bool affine = shape.follows == Follows::affine;
  if (affine) laid.points = affine_points(shape, laid.points);
  laid.points.erase(std::remove_if(laid.points.begin(), laid.points.end(),
                                   [](const RestPoint& p) { return !(p.mass > 0); }),
                    laid.points.end());
  Packed packed = pack(laid.points, part.density());
  MassPoints out;
  out.at = std::move(packed.at);
  out.mass = std::move(packed.mass);
  out.n_points = static_cast<int>(laid.points.size());
  out.rule = affine ? "affine" : shape.by_sections ? "sections" : shape.points_apart ? "full" : "rings";
  out.level = laid.level;
  out.unsettled = laid.left;
  return out;
}

}  // namespace pliant
