#include "body_rule.h"

#include <array>
#include <limits>
#include <stdexcept>
#include <string>

#include "rest_rules.h"

namespace pliant {

namespace {

/// Nodes a panel, by level of refinement; two levels double them.
constexpr std::array<int, 12> kSizes{3, 5, 7, 10, 14, 20, 28, 40, 56, 80, 112, 160};
constexpr std::size_t kLastLevel = kSizes.size() - 3;
/// Changes of moments that are rounding, relative to the volume; and what is taken when no more is to be had.
constexpr double kTolerance = 5e-14, kNoise = 1e-12;
constexpr Eigen::Index kMostPoints = 2'000'000;

/// Along u, v and w.
using Levels = std::array<std::size_t, 3>;

struct Nodes3 {
  std::vector<AngleNode> u, v;
  std::vector<QuadratureNode> w;
  Nodes3(const RestShape& shape, const Levels& levels)
      : u(profile_nodes(shape, kSizes[levels[0]])),
        v(ring_nodes(shape, kSizes[levels[1]])),
        w(depth_nodes(shape, kSizes[levels[2]])) {}
  Eigen::Index count() const { return static_cast<Eigen::Index>(u.size() * v.size() * w.size()); }
};

BodyRule points_of(const RestShape& shape, const Levels& levels) {
  const Nodes3 nodes(shape, levels);
  if (nodes.count() > kMostPoints)
    throw std::invalid_argument("part '" + shape.part.name() + "': integrals over its body need " +
                                std::to_string(nodes.count()) + " points, more than " +
                                std::to_string(kMostPoints) +
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

/// Integrals of all products, relative to the volume.
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

/// Refines along one direction until no moment changes, the others being coarse.
std::size_t settle(const RestShape& shape, const LegendreProducts& polynomials, std::size_t direction,
                   double& left) {
  std::vector<VecX<double>> known;
  auto at = [&](std::size_t level) -> const VecX<double>& {
    while (known.size() <= level) {
      Levels levels{1, 1, 1};
      levels[direction] = known.size();
      known.push_back(moments(points_of(shape, levels), polynomials));
    }
    return known[level];
  };
  double least = std::numeric_limits<double>::infinity();
  std::size_t best = 0;
  for (std::size_t level = 0; level <= kLastLevel; ++level) {
    at(level + 2);
    const double change = (at(level) - at(level + 2)).lpNorm<Eigen::Infinity>();
    if (change <= kTolerance) return level;
    if (change < 0.5 * least) {
      least = change;
      best = level;
    }
    if (least <= kNoise && level >= best + 2) break;
  }
  left = std::max(left, least);
  return best;
}

}  // namespace

BodyRule make_body_rule(const Part& part, const LegendreProducts& polynomials) {
  RestShape shape(part);
  shape.points_apart = true;
  Levels levels{};
  double left = 0;
  for (std::size_t direction = 0; direction < 3; ++direction)
    levels[direction] = settle(shape, polynomials, direction, left);
  BodyRule rule = points_of(shape, levels);
  rule.unsettled = left;
  return rule;
}

}  // namespace pliant
