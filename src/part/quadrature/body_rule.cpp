// The search for a quadrature over the body of a solid.
#include "body_rule.h"

#include <array>
#include <limits>
#include <stdexcept>
#include <string>

#include "rest_rules.h"

namespace pliant {

namespace {

/// Number of nodes in a panel for each level of refinement. Two further levels about double this number.
constexpr std::array<int, 12> kBodySizes{3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160};
constexpr std::size_t kLastBodyLevel = kBodySizes.size() - 3;
/// Changes of the moments by two further levels, relative to the volume. A rule whose change is at most
/// kMomentTolerance has converged. The search also ends if the change is at most kAcceptableChange and two
/// further levels do not halve this change.
constexpr double kMomentTolerance = 5e-14, kAcceptableChange = 1e-12;
constexpr Eigen::Index kMaxBodyPoints = 2'000'000;

/// Levels of refinement along u, v and w.
using Levels = std::array<std::size_t, 3>;

struct Nodes3 {
  std::vector<AngleNode> u, v;
  std::vector<QuadratureNode> w;
  Nodes3(const RestShape& shape, const Levels& levels)
      : u(profile_nodes(shape, kBodySizes[levels[0]])),
        v(ring_nodes(shape, kBodySizes[levels[1]])),
        w(depth_nodes(shape, kBodySizes[levels[2]])) {}
  Eigen::Index count() const { return static_cast<Eigen::Index>(u.size() * v.size() * w.size()); }
};

/// Returns the rule with the given levels along u, v and w.
BodyRule rule_of(const RestShape& shape, const Levels& levels) {
  const Nodes3 nodes(shape, levels);
  if (nodes.count() > kMaxBodyPoints)
    throw std::invalid_argument("part '" + shape.part.name() + "': integrals over its body need " +
                                std::to_string(nodes.count()) + " points, more than " +
                                std::to_string(kMaxBodyPoints) +
                                "; expected a lower degree, a smoother shape, or the basis \"nodes\"");
  std::vector<RestPoint> points;
  for (const AngleNode& u : nodes.u)
    for (const QuadratureNode& w : nodes.w) add_ring(shape, u, w, nodes.v, points);
  BodyRule rule;
  rule.volume.resize(static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k) {
    rule.at.push_back(points[k].at);
    rule.volume[static_cast<Eigen::Index>(k)] = points[k].mass;
  }
  rule.X = shape.part.s(rule.at, shape.rest);
  return rule;
}

/// Returns the integrals of all products of Legendre polynomials, relative to the volume.
VecX<double> moments(const BodyRule& rule, const LegendreProducts& polynomials) {
  VecX<double> sum = VecX<double>::Zero(polynomials.size());
  constexpr Eigen::Index block = 2048;
  for (Eigen::Index first = 0; first < rule.X.cols(); first += block) {
    const Eigen::Index count = std::min(block, rule.X.cols() - first);
    sum.noalias() +=
        polynomials.values(rule.X.middleCols(first, count)).transpose() * rule.volume.segment(first, count);
  }
  return sum / rule.volume.sum();
}

/// Returns the first level along one direction at which two further levels change no moment by more than
/// kMomentTolerance. The other directions have coarse nodes. If there is no such level, selects the first
/// level, and then every level whose change is less than half of the change of the level selected before.
/// The result is the level selected last; `remaining` becomes its change if `remaining` was smaller.
std::size_t refine_direction(const RestShape& shape, const LegendreProducts& polynomials,
                             std::size_t direction, double& remaining) {
  std::vector<VecX<double>> known;
  auto at = [&](std::size_t level) -> const VecX<double>& {
    while (known.size() <= level) {
      Levels levels{1, 1, 1};
      levels[direction] = known.size();
      known.push_back(moments(rule_of(shape, levels), polynomials));
    }
    return known[level];
  };
  double min_change = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  for (std::size_t level = 0; level <= kLastBodyLevel; ++level) {
    at(level + 2);
    const double change = (at(level) - at(level + 2)).lpNorm<Eigen::Infinity>();
    if (change <= kMomentTolerance) return level;
    if (change < 0.5 * min_change) {
      min_change = change;
      best = level;
    }
    if (min_change <= kAcceptableChange && level >= best + 2) break;
  }
  remaining = std::max(remaining, min_change);
  return best;
}

}  // namespace

BodyRule make_body_rule(const Part& part, const LegendreProducts& polynomials) {
  RestShape shape(part);
  shape.points_apart = true;
  Levels levels{};
  double remaining = 0;
  for (std::size_t direction = 0; direction < 3; ++direction)
    levels[direction] = refine_direction(shape, polynomials, direction, remaining);
  BodyRule rule = rule_of(shape, levels);
  rule.remaining_change = remaining;
  return rule;
}

}  // namespace pliant
