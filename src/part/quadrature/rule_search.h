// The search for a rule of quadrature over the rest shape of a part: along each direction nodes are doubled
// until no integral changes, then thinned to as few as give the same integrals. Both are judged by integrands
// at states spread over the ranges of the dynamic parameters, at places spread over the other directions.
// Integrands says what they are:
//   what            "mass matrix", for messages
//   kEach           functions a state
//   kSettled        relative change by doubling at which a rule has settled; kPromised: what must be reached
//   kThin           what thinning may change
//   n()             dynamic parameters
//   shares(columns, n_states)  what each node contributes to each function
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/math/thin_rule.h>

#include "rest_rules.h"

namespace pliant::rule_search {

/// Nodes a panel, by level of refinement; two levels double them.
inline constexpr std::array<int, 15> kSizes{3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 224, 320, 448};
inline constexpr int kLastLevel = static_cast<int>(kSizes.size()) - 3;
inline int size_at(int level) {
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

/// States spread over the ranges of the dynamic parameters.
class StateRanges {
 public:
  explicit StateRanges(const Part& part) {
    const Parameters& all = part.parameters();
    for (int i : all.dynamic()) {
      const Parameter& p = all[i];
      const double rest = p.rest_value();
      // Lengths scale the body: from half to twice their rest value tells all; offsets up to twice its size.
      const bool offset = !p.spec->relative && p.spec->quantity == Quantity::length;
      const double scale = p.spec->relative ? rest : (offset ? part.size() : std::max(1.0, std::abs(rest)));
      const double reach = offset ? 2 * scale : kInfinity;
      // So do numbers that range over orders of magnitude.
      const bool wide = p.spec->relative || p.limits.max > 100 * scale;
      ranges_.push_back({std::max({p.limits.min, wide ? 0.5 * rest : -kInfinity, -reach}),
                         std::min({p.limits.max, wide ? 2 * rest : kInfinity, reach}), rest, scale});
    }
  }
  int n() const { return static_cast<int>(ranges_.size()); }
  /// A size of the k-th parameter.
  double scale(int k) const { return ranges_[static_cast<std::size_t>(k)].scale; }
  /// The values and rates of a state: the first one at rest, every third one at a corner of the ranges, where
  /// integrands are at their worst.
  void draw(Draw& draw, int state, VecMax<double>& q, VecMax<double>& rate) const {
    q.resize(n());
    rate.resize(n());
    for (int i = 0; i < n(); ++i) {
      const RangeOf& range = ranges_[static_cast<std::size_t>(i)];
      const double inside = draw.uniform();
      const double mix = state % 3 == 1 ? std::round(inside) : inside;
      q[i] = state == 0 ? range.rest : range.low + mix * (range.high - range.low);
      rate[i] = range.scale * draw.either_way();
    }
  }

 private:
  struct RangeOf {
    double low, high, rest, scale;
  };
  std::vector<RangeOf> ranges_;
};

/// The smallest level at which doubling changes no integral; columns(level) lays the nodes. Notes the change
/// that is left if the last level does not suffice.
template <class Integrands, class MakeColumns>
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
    if (change <= Integrands::kSettled) return level;
    if (change < 0.5 * least_change) {
      least_change = change;
      best = level;
    }
    // Sums of terms that cancel keep a rounding of their own, which no finer rule takes away.
    if (least_change <= Integrands::kPromised && level >= best + 2) return best;
  }
  left = std::max(left, least_change);
  return kLastLevel;
}

/// Keeps of the nodes of one direction as many as their integrals need.
template <class Integrands, class Node>
void thin(const Integrands& integrands, const Columns& line, std::vector<Node>& nodes) {
  Eigen::VectorXd factors;
  for (int n_states = 80;; n_states *= 2) {
    Eigen::Index rank = 0;
    factors = thin_rule(integrands.shares(line, n_states), &rank, Integrands::kThin);
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
inline constexpr std::size_t kMostPoints = 2'000'000;
[[noreturn]] inline void too_many_points(const Part& part, const char* what) {
  std::string names;
  for (int i : part.parameters().dynamic()) names += (names.empty() ? "" : ", ") + part.parameters()[i].name;
  throw std::invalid_argument("part '" + part.name() + "': its " + what + " needs more than " +
                              std::to_string(kMostPoints) + " points to be exact for all of " + names +
                              "; narrow the limits of some of them (min, max), or freeze them");
}

struct Laid {
  std::vector<RestPoint> points;
  int level = 0;
  double left = 0;
};

/// Thinning takes time that grows with the cube of the nodes: more take longer than most runs would save.
inline constexpr std::size_t kMostThinned = 600;

/// A ring of material points.
struct RingNode {
  AngleNode u;
  QuadratureNode w;
  double weight = 1;  ///< on top of those of u and w
};
inline void add_ring(const RestShape& shape, const RingNode& ring, const std::vector<AngleNode>& v,
                     std::vector<RestPoint>& out) {
  QuadratureNode w = ring.w;
  w.weight *= ring.weight;
  add_ring(shape, ring.u, w, v, out);
}

/// Rings of points. thinned: to as few as the integrands need.
template <class Integrands>
Laid lay_rings(const RestShape& shape, const Integrands& integrands, bool thinned, int extra) {
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
  if (n_points > kMostPoints) too_many_points(shape.part, Integrands::what);
  for (const RingNode& ring : rings) add_ring(shape, ring, v, laid.points);
  return laid;
}
}  // namespace pliant::rule_search
