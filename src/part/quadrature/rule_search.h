// The search for a quadrature rule over the rest shape of a part. Along each direction the number of nodes is
// increased until doubling changes no integral. Then the rule is thinned: as many nodes are removed as the
// integrals allow. Both steps use integrands at states and places. States are spread over the ranges of the
// dynamic parameters; places are random nodes of the other directions. A class Integrands defines the
// integrands:
//   subject         "mass matrix", for messages
//   kEach           number of integrands for each state
//   kTolerance      relative change by doubling at which a rule has converged
//   kRequired       relative change that is accepted if finer rules do not reduce it
//   last_level()    the last level of refinement, at most kLastLevel
//   thinning()      accuracy of thinning
//   n_states()      number of states at which a rule is tested
//   shares(columns, first, end)  the contribution of each node (row) to each integral (column) at the states
//                   from number `first` to number end - 1
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

/// Number of nodes in a panel for each level of refinement. Two further levels about double this number.
inline constexpr std::array<int, 15> kSizes{3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160, 224, 320, 448};
inline constexpr int kLastLevel = static_cast<int>(kSizes.size()) - 3;
inline int size_at(int level) {
  return kSizes[static_cast<std::size_t>(std::min<int>(level, static_cast<int>(kSizes.size()) - 1))];
}

/// Pseudo-random numbers by xorshift. Each new object gives the same sequence on every machine.
class Draw {
 public:
  /// Returns a number in [0, 1).
  double uniform() {
    seed_ ^= seed_ << 13;
    seed_ ^= seed_ >> 7;
    seed_ ^= seed_ << 17;
    return static_cast<double>(seed_ >> 11) * 0x1.0p-53;
  }
  /// Returns a number in [-1, 1).
  double symmetric() { return 2 * uniform() - 1; }
  /// Returns an index below n.
  std::size_t below(std::size_t n) {
    return std::min(n - 1, static_cast<std::size_t>(uniform() * static_cast<double>(n)));
  }

 private:
  std::uint64_t seed_ = 0x9e3779b97f4a7c15u;
};

/// The accuracy of thinning.
struct Thinning {
  double tolerance;  ///< relative change of an integral that thinning may make
  /// Smallest number of sampled integrands for each dimension of the space that they span. With few
  /// integrands the sample does not span the space of all integrands.
  int integrands_of_rank = 3;
};

/// The quadrature points of all nodes of one direction, at one place of the other directions.
struct Column {
  std::vector<RestPoint> points;
  std::vector<Eigen::Index> node;  ///< number of the node of each point
  /// Assigns to node number `which` the points that were appended since the last call.
  void end_node(Eigen::Index which) { node.resize(points.size(), which); }
};
/// Columns at several places; n_nodes is the number of nodes along the direction.
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
      // An offset is a length that is not relative to its rest value. The states keep an offset within twice
      // the size of the body.
      const bool offset = !p.spec->relative && p.spec->quantity == Quantity::length;
      const double scale = p.spec->relative ? rest : (offset ? part.size() : std::max(1.0, std::abs(rest)));
      const double reach = offset ? 2 * scale : kInfinity;
      // Lengths that scale the body, and parameters whose upper limit is above 100 times the scale, stay
      // between half and twice the rest value. If this rest value is 0, as for an offset without limits, only
      // 0 is used.
      const bool wide = p.spec->relative || p.limits.max > 100 * scale;
      ranges_.push_back({std::max({p.limits.min, wide ? 0.5 * rest : -kInfinity, -reach}),
                         std::min({p.limits.max, wide ? 2 * rest : kInfinity, reach}), rest, scale});
    }
  }
  int n() const { return static_cast<int>(ranges_.size()); }
  /// Draws values q and rates of a state. State 0 has the rest values. Every third state is at a corner of
  /// the ranges, where the integrands are hardest to integrate.
  void draw(Draw& draw, int state, VecMax<double>& q, VecMax<double>& rate) const {
    q.resize(n());
    rate.resize(n());
    for (int i = 0; i < n(); ++i) {
      const RangeOf& range = ranges_[static_cast<std::size_t>(i)];
      const double inside = draw.uniform();
      const double mix = state % 3 == 1 ? std::round(inside) : inside;
      q[i] = state == 0 ? range.rest : range.low + mix * (range.high - range.low);
      rate[i] = range.scale * draw.symmetric();
    }
  }

 private:
  struct RangeOf {
    double low, high, rest, scale;
  };
  std::vector<RangeOf> ranges_;
};

/// Returns the first level of refinement at which doubling changes no integral by more than kTolerance, or
/// the first level whose change is at most kRequired and is not halved by the next two levels. If there is no
/// such level, returns the last level and raises `remaining` to the smallest change found (within a factor of
/// 2). columns(level) returns the points of the nodes of a level.
template <class Integrands, class MakeColumns>
int refine(const Integrands& integrands, double& remaining, const MakeColumns& columns) {
  struct Integrals {
    Eigen::VectorXd value, size;
  };
  const int n_states = integrands.n_states();
  std::vector<Integrals> known;
  auto at = [&](int level) -> const Integrals& {
    while (static_cast<int>(known.size()) <= level) {
      const Eigen::MatrixXd F = integrands.shares(columns(static_cast<int>(known.size())), 0, n_states);
      known.push_back({F.colwise().sum(), F.cwiseAbs().colwise().sum()});
    }
    return known[static_cast<std::size_t>(level)];
  };
  double min_change = kInfinity;
  int best = 0;
  for (int level = 0; level <= integrands.last_level(); ++level) {
    at(level + 2);
    const Integrals &now = at(level), &finer = at(level + 2);
    // The change of a small integral is relative to a tenth of the mean size of all integrals.
    const double min_size = 0.1 * finer.size.mean();
    if (min_size == 0) return level;
    const double change =
        ((now.value - finer.value).array().abs() / finer.size.array().max(min_size)).maxCoeff();
    if (change <= Integrands::kTolerance) return level;
    if (change < 0.5 * min_change) {
      min_change = change;
      best = level;
    }
    // If terms of a sum cancel, no finer rule reduces the rounding errors.
    if (min_change <= Integrands::kRequired && level >= best + 2) return best;
  }
  remaining = std::max(remaining, min_change);
  return integrands.last_level();
}

/// Removes the nodes of one direction that the integrals do not need, and adjusts the weights of the other
/// nodes. line: the points of the nodes.
template <class Integrands, class Node>
void thin(const Integrands& integrands, const Columns& line, std::vector<Node>& nodes) {
  const Thinning thinning = integrands.thinning();
  Eigen::VectorXd factors;
  Eigen::MatrixXd F(line.n_nodes, 0);
  for (int known = 0, n_states = 80;; known = n_states, n_states *= 2) {
    const Eigen::MatrixXd further = integrands.shares(line, known, n_states);
    F.conservativeResize(Eigen::NoChange, F.cols() + further.cols());
    F.rightCols(further.cols()) = further;
    Eigen::Index rank = 0;
    factors = thin_rule(F, &rank, thinning.tolerance);
    // Stop when further states would add no new integrand, which means that the rank is far below the number
    // of integrands, or when no node can be removed.
    if (thinning.integrands_of_rank * rank <= F.cols() || rank >= line.n_nodes) break;
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

/// Maximum number of points. With more points, a step would take a large part of a second.
inline constexpr std::size_t kMaxPoints = 2'000'000;
[[noreturn]] inline void throw_too_many_points(const Part& part, const char* subject) {
  std::string names;
  for (int i : part.parameters().dynamic()) names += (names.empty() ? "" : ", ") + part.parameters()[i].name;
  throw std::invalid_argument("part '" + part.name() + "': its " + subject + " needs more than " +
                              std::to_string(kMaxPoints) + " points to be exact over the ranges of " + names +
                              "; narrow the limits of some of them (min, max), or freeze them");
}

/// The result of a search.
struct PlacedPoints {
  std::vector<RestPoint> points;
  int level = 0;         ///< level of refinement along the last direction
  double remaining = 0;  ///< largest `remaining` of refine(); 0 if every search found a level that suffices
};

inline void remove_massless(std::vector<RestPoint>& points) {
  points.erase(std::remove_if(points.begin(), points.end(), [](const RestPoint& p) { return !(p.mass > 0); }),
               points.end());
}

/// Maximum number of rings to thin together, and number of rings in a group of a larger set. The time of
/// thinning grows with the cube of these numbers.
inline constexpr std::size_t kMaxThinned = 600, kThinnedGroup = 200;

/// A ring of material points.
struct RingNode {
  AngleNode u;
  QuadratureNode w;
  double weight = 1;  ///< factor on the weights of u and w
};
inline void add_ring(const RestShape& shape, const RingNode& ring, const std::vector<AngleNode>& v,
                     std::vector<RestPoint>& out) {
  QuadratureNode w = ring.w;
  w.weight *= ring.weight;
  add_ring(shape, ring.u, w, v, out);
}

/// The search for rings of points, which chooses nodes along v, then w, then u.
template <class Integrands>
class RingSearch {
 public:
  /// thinned: whether to thin the nodes along u and w. search_v() decides whether the nodes along v are
  /// thinned. extra: number of levels of refinement beyond the level that suffices.
  RingSearch(const RestShape& shape, const Integrands& integrands, bool thinned, int extra)
      : shape_(shape), integrands_(integrands), thinned_(thinned), extra_(extra) {}

  PlacedPoints run() {
    PlacedPoints placed;
    search_v(placed);
    if (!shape_.part.shell()) search_w(placed);
    search_u(placed);
    // A rule that is thinned may have no point in a fold. ring_moments() throws where the surface folds over.
    for (const AngleNode& at : u_) ring_moments(shape_, at, {1, 0, 1}, whole_ring_);
    // Thinning all pairs (u, w) together leaves fewer rings than thinning along u and along w alone.
    std::vector<RingNode> rings;
    for (const AngleNode& at : u_)
      for (const QuadratureNode& depth : w_) rings.push_back({at, depth});
    if (thinned_ && w_.size() > 1) thin_rings(rings);

    const std::size_t n_points = rings.size() * (shape_.points_apart ? v_.size() * shape_.images() : 3);
    if (n_points > kMaxPoints) throw_too_many_points(shape_.part, Integrands::subject);
    for (const RingNode& ring : rings) add_ring(shape_, ring, v_, placed.points);
    return placed;
  }

 private:
  static constexpr int kCoarse = 5, kPlaces = 16;
  static constexpr std::size_t kSmallRing = 64;  // RingMoments thins rings with more nodes along v

  /// Integrands of the moments of rings of a solid at random nodes of u and w. A rule along v that is thinned
  /// for these integrands has few nodes, so that the search along u and w is fast. For shells such a rule is
  /// not used, because their moments contain roots and span spaces of high dimension.
  struct RingMoments {
    static constexpr int kEach = 6;
    const RingSearch& search;
    static Thinning thinning() { return {1e-15}; }
    Eigen::MatrixXd shares(const Columns& line, int first, int end) const {
      Eigen::MatrixXd F(line.n_nodes, kEach * (end - first));
      Draw draw;
      for (int k = 0; k < end; ++k) {
        const AngleNode& u = search.u_[draw.below(search.u_.size())];
        const QuadratureNode& w = search.w_[draw.below(search.w_.size())];
        if (k >= first)
          F.middleCols<kEach>(kEach * (k - first)) = ring_moments(search.shape_, u, w, search.v_);
      }
      return F;
    }
  };

  void search_v(PlacedPoints& placed) {
    const int level =
        refine(integrands_, placed.remaining, [&](int l) { return along_v(ring_nodes(shape_, size_at(l))); });
    v_ = ring_nodes(shape_, size_at(level + extra_));
    whole_ring_ = v_;
    if (shape_.points_apart)
      thin(integrands_, along_v(v_), v_);
    else if (!shape_.part.shell() && shape_.distribution == nullptr && v_.size() > kSmallRing)
      thin(RingMoments{*this}, Columns{{}, static_cast<Eigen::Index>(v_.size())}, v_);
  }
  void search_w(PlacedPoints& placed) {
    const int level = refine(integrands_, placed.remaining,
                             [&](int l) { return along_w(depth_nodes(shape_, size_at(l))); });
    w_ = depth_nodes(shape_, size_at(level + extra_));
    if (thinned_) thin(integrands_, along_w(w_), w_);
  }
  void search_u(PlacedPoints& placed) {
    placed.level = refine(integrands_, placed.remaining,
                          [&](int l) { return along_u(profile_nodes(shape_, size_at(l))); });
    u_ = profile_nodes(shape_, size_at(placed.level + extra_));
    if (thinned_) thin(integrands_, along_u(u_), u_);
  }

  /// Removes rings that the integrals do not need. Large sets are thinned in groups of neighbouring rings, as
  /// long as this removes at least a quarter of the first group.
  void thin_rings(std::vector<RingNode>& rings) const {
    while (rings.size() > kMaxThinned) {
      const std::size_t before = rings.size(), groups = (before + kThinnedGroup - 1) / kThinnedGroup;
      std::vector<RingNode> kept;
      for (std::size_t g = 0; g < groups; ++g) {
        std::vector<RingNode> group(rings.begin() + static_cast<std::ptrdiff_t>(g * before / groups),
                                    rings.begin() + static_cast<std::ptrdiff_t>((g + 1) * before / groups));
        const std::size_t all = group.size();
        thin(integrands_, along_rings(group), group);
        if (g == 0 && 4 * group.size() > 3 * all) return;
        kept.insert(kept.end(), group.begin(), group.end());
      }
      rings = std::move(kept);
    }
    thin(integrands_, along_rings(rings), rings);
  }

  // The functions along_*() return the points of the nodes of one direction, at random places of the other
  // directions. If the points of a ring do not move independently, a column has whole rings.

  Columns along_v(const std::vector<AngleNode>& nodes) const {
    Columns line;
    Draw draw;
    for (int k = 0; k < kPlaces; ++k) {
      Column column;
      add_ring(shape_, u_[draw.below(u_.size())], w_[draw.below(w_.size())], nodes, column.points);
      for (std::size_t i = 0; i < column.points.size(); ++i)
        column.node.push_back(shape_.points_apart ? static_cast<Eigen::Index>(i / shape_.images()) : 0);
      line.columns.push_back(std::move(column));
    }
    line.n_nodes = shape_.points_apart ? static_cast<Eigen::Index>(nodes.size()) : 1;
    return line;
  }
  Columns along_w(const std::vector<QuadratureNode>& nodes) const {
    Columns line;
    Draw draw;
    for (int k = 0; k < kPlaces; ++k) {
      const AngleNode& u = u_[draw.below(u_.size())];
      line.columns.push_back(rings_at(draw, nodes, [&](const QuadratureNode& w) { return RingNode{u, w}; }));
    }
    line.n_nodes = static_cast<Eigen::Index>(nodes.size());
    return line;
  }
  Columns along_u(const std::vector<AngleNode>& nodes) const {
    Columns line;
    Draw draw;
    const int places = !shape_.points_apart && w_.size() == 1 ? 1 : kPlaces;
    for (int k = 0; k < places; ++k) {
      const QuadratureNode& w = w_[draw.below(w_.size())];
      line.columns.push_back(rings_at(draw, nodes, [&](const AngleNode& u) { return RingNode{u, w}; }));
    }
    line.n_nodes = static_cast<Eigen::Index>(nodes.size());
    return line;
  }
  Columns along_rings(const std::vector<RingNode>& nodes) const {
    Columns line;
    Draw draw;
    for (int k = 0; k < (shape_.points_apart ? kPlaces : 1); ++k)
      line.columns.push_back(rings_at(draw, nodes, [](const RingNode& ring) { return ring; }));
    line.n_nodes = static_cast<Eigen::Index>(nodes.size());
    return line;
  }

  /// Returns the points of a ring for each node: the whole ring, or the point at one random node of v if the
  /// points of a ring move independently.
  template <class Node, class MakeRing>
  Column rings_at(Draw& draw, const std::vector<Node>& nodes, const MakeRing& make_ring) const {
    const std::vector<AngleNode> v =
        shape_.points_apart ? std::vector<AngleNode>{v_[draw.below(v_.size())]} : v_;
    Column column;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      add_ring(shape_, make_ring(nodes[i]), v, column.points);
      column.end_node(static_cast<Eigen::Index>(i));
    }
    return column;
  }

  const RestShape& shape_;
  const Integrands& integrands_;
  bool thinned_;
  int extra_;
  // The nodes found so far. Directions that have not been searched yet have coarse nodes.
  std::vector<AngleNode> u_ = profile_nodes(shape_, kCoarse), v_ = ring_nodes(shape_, kCoarse);
  std::vector<QuadratureNode> w_ = depth_nodes(shape_, kCoarse);
  std::vector<AngleNode> whole_ring_;  // nodes along v before thinning
};

}  // namespace pliant::rule_search
