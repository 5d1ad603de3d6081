#include <pliant/part/quadrature/body_points.h>

#include <sstream>
#include <stdexcept>
#include <string>

#include "match_moments.h"
#include "rest_rules.h"

namespace pliant {

namespace {

constexpr std::size_t kMaxGridPoints = 2'000'000;

}  // namespace

BodyPoints place_body_points(const Part& part, int n) {
  RestShape shape(part, part.mass_distribution());
  shape.points_apart = true;
  const std::vector<AngleNode> u = profile_nodes(shape, n), v = ring_nodes(shape, n);
  const std::vector<QuadratureNode> w = depth_nodes(shape, n);
  const std::size_t count = u.size() * v.size() * w.size();
  if (count > kMaxGridPoints)
    throw std::invalid_argument("part '" + part.name() + "': integrals over its mass need " +
                                std::to_string(count) + " points, more than " +
                                std::to_string(kMaxGridPoints) + "; expected a smaller resolution");
  std::vector<RestPoint> all;
  for (const AngleNode& at_u : u)
    for (const QuadratureNode& at_w : w) add_ring(shape, at_u, at_w, v, all);
  BodyPoints points{{}, VecX<double>(static_cast<Eigen::Index>(all.size()))};
  for (const RestPoint& point : all) {
    points.mass[static_cast<Eigen::Index>(points.at.size())] = part.density() * point.mass;
    points.at.push_back(point.at);
  }
  return points;
}

BodyPoints place_matched_body_points(const Part& part, int n) {
  BodyPoints points = place_body_points(part, n);
  points.mass *= part.total_mass() / points.mass.sum();
  const Nodes X = part.s(points.at, part.parameters().rest()).transpose();
  const double missing = match_moments(part.rest_inertia(), X, points.mass);
  if (!(missing <= kMatched)) {
    std::ostringstream message;
    message << "part '" << part.name() << "': points of resolution " << n
            << " cannot have its mass, centre and inertia: a relative share of " << missing
            << " of a moment is missing; expected a larger resolution";
    throw std::invalid_argument(message.str());
  }
  return points;
}

}  // namespace pliant
