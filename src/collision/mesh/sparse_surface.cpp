// The search for mesh lines that a surface does not need.
#include <pliant/collision/mesh/sparse_surface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

namespace pliant {

namespace {

/// A point is on a triangle if it is within this distance, in sizes of the part (Part::size()).
constexpr double kOnTriangle = 1e-10;
/// The test values of the dynamic parameters differ from their rest values by a share (kShares) of the rest
/// value, or of kProbe where the rest value is zero. The share of parameter k is multiplied by
/// 1 + kUneven * (k modulo kUnevenPeriod), so that the shares of several parameters are not equal.
constexpr std::array<double, 2> kShares{0.3, -0.2};
constexpr double kProbe = 1, kUneven = 0.13;
constexpr int kUnevenPeriod = 13;

/// Returns the values of the parameters at rest and, if some are dynamic, two other sets of values.
std::vector<ParameterValues<double>> probes(const Part& part) {
  const Parameters& parameters = part.parameters();
  std::vector<ParameterValues<double>> all{parameters.rest()};
  const int n = parameters.n_dynamic();
  for (std::size_t probe = 0; n > 0 && probe < kShares.size(); ++probe) {
    VecMax<double> q_s(n), q_s_dot = VecMax<double>::Zero(n);
    for (int k = 0; k < n; ++k) {
      const double rest = parameters.moving(k).rest_value();
      q_s[k] = rest + kShares[probe] * (1 + kUneven * (k % kUnevenPeriod)) * (rest == 0 ? kProbe : rest);
    }
    all.push_back(parameters.expand<double>(q_s, q_s_dot));
  }
  return all;
}

/// Returns the vertices and the centres of the triangles of a surface, m.
Eigen::Matrix3Xd test_points(const Part& part, const Surface& surface,
                             const ParameterValues<double>& values) {
  const Eigen::Matrix3Xd x = part.s(surface.material(), values);
  const Eigen::Matrix3Xi& triangles = surface.triangles();
  Eigen::Matrix3Xd points(3, x.cols() + triangles.cols());
  points.leftCols(x.cols()) = x;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t)
    points.col(x.cols() + t) = (x.col(triangles(0, t)) + x.col(triangles(1, t)) + x.col(triangles(2, t))) / 3;
  return points;
}

/// Returns whether each point is on one of the triangles of a mesh. points, x: columns, m; within: m.
/// Triangles thinner than `within` contain no points.
bool are_on(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles,
            double within) {
  struct Side {
    Vec3<double> corner, normal;
    std::array<Vec3<double>, 3> inward;  ///< normals of the edges in the plane of the triangle
    std::array<double, 3> offset;        ///< of the edges, m
  };
  std::vector<Side> sides;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    std::array<Vec3<double>, 3> p;
    for (int k = 0; k < 3; ++k) p[static_cast<std::size_t>(k)] = x.col(triangles(k, t));
    const Vec3<double> normal = (p[1] - p[0]).cross(p[2] - p[0]);
    const double longest = std::max({(p[1] - p[0]).norm(), (p[2] - p[1]).norm(), (p[0] - p[2]).norm()});
    if (!(normal.norm() > within * longest)) continue;
    Side side;
    side.corner = p[0];
    side.normal = normal.normalized();
    for (std::size_t k = 0; k < 3; ++k) {
      side.inward[k] = side.normal.cross(p[(k + 1) % 3] - p[k]).normalized();
      side.offset[k] = side.inward[k].dot(p[k]);
    }
    sides.push_back(side);
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Vec3<double> p = points.col(i);
    const bool on = std::any_of(sides.begin(), sides.end(), [&](const Side& side) {
      bool inside = std::abs(side.normal.dot(p - side.corner)) <= within;
      for (std::size_t k = 0; k < 3; ++k) inside = inside && side.inward[k].dot(p) >= side.offset[k] - within;
      return inside;
    });
    if (!on) return false;
  }
  return true;
}

}  // namespace

Surface sparse_surface(const Part& part, int resolution, double cell) {
  Surface sparse(part, resolution);
  if (part.shape().mesh() != MeshPattern::ball) return sparse;
  const std::vector<ParameterValues<double>> all = probes(part);
  std::vector<Eigen::Matrix3Xd> points;  // at all values
  for (const ParameterValues<double>& values : all) points.push_back(test_points(part, sparse, values));
  const Vec3<double> extent = points[0].rowwise().maxCoeff() - points[0].rowwise().minCoeff();
  std::array<int, 3> spacing{1, 1, 1};
  for (const std::size_t axis : {0U, 1U, 2U})
    for (int cells = 1; cells < 2 * resolution; ++cells) {
      if (2 * resolution % cells != 0 || !(extent[static_cast<Eigen::Index>(axis)] <= cells * cell)) continue;
      std::array<int, 3> wider = spacing;
      wider[axis] = 2 * resolution / cells;
      Surface candidate(part, resolution, wider);
      bool same = true;
      for (std::size_t k = all.size(); same && k-- > 0;)  // last the rest shape, which fails least often
        same = are_on(points[k], part.s(candidate.material(), all[k]), candidate.triangles(),
                      kOnTriangle * part.size());
      if (!same) continue;
      spacing = wider;
      sparse = std::move(candidate);
      break;
    }
  return sparse;
}

}  // namespace pliant
