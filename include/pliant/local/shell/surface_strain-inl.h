// Function bodies of surface_strain.h.
#pragma once

#include <array>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>

#include <pliant/local/shell/edge_strain.h>
#include <pliant/local/shell/surface_strain.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// A triangle is ignored if its area is at most this fraction of the square of its longest edge.
inline constexpr double kSurfaceFlatTriangle = 1e-7;

/// Returns the edges of triangle t with the vertices at x.
inline Edges<double> surface_edges(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles,
                                   Eigen::Index t) {
  return edges_of<double>({x.col(triangles(0, t)), x.col(triangles(1, t)), x.col(triangles(2, t))});
}

/// Returns |e_k|^2/2.
inline Vec3<double> surface_half_squares(const Edges<double>& e) {
  const std::array<double, 3> q = half_squares(e);
  return {q[0], q[1], q[2]};
}

}  // namespace detail

PLIANT_INLINE SurfaceStrain::SurfaceStrain(const Eigen::Matrix3Xd& X, Eigen::Matrix3Xi triangles)
    : triangles_(std::move(triangles)), area_around_(VecX<double>::Zero(X.cols())) {
  rest_.reserve(static_cast<std::size_t>(triangles_.cols()));
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    const Edges<double> e = detail::surface_edges(X, triangles_, t);
    const Vec3<double> twice_area = e[0].cross(e[1]);
    Triangle rest{detail::surface_half_squares(e), Mat3<double>::Zero(), 0.5 * twice_area.norm()};
    if (rest.area > detail::kSurfaceFlatTriangle * 2 * rest.rest.maxCoeff()) {
      const Vec3<double> t1 = e[0].normalized(), t2 = twice_area.normalized().cross(t1);
      const std::array<Mat3<double>, 3> B = edge_strains(e);
      for (std::size_t k = 0; k < 3; ++k)
        rest.G_of_q.col(static_cast<Eigen::Index>(k)) << t1.dot(B[k] * t1), t2.dot(B[k] * t2),
            t1.dot(B[k] * t2);
      for (int k = 0; k < 3; ++k) area_around_[triangles_(k, t)] += rest.area;
    } else {
      rest.area = 0;
    }
    rest_.push_back(rest);
  }
}

PLIANT_INLINE VecX<double> SurfaceStrain::at(const Eigen::Matrix3Xd& x) const {
  VecX<double> sum = VecX<double>::Zero(area_around_.size());
  for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
    const Triangle& rest = rest_[static_cast<std::size_t>(t)];
    if (rest.area == 0) continue;
    const Vec3<double> G =
        rest.G_of_q * (detail::surface_half_squares(detail::surface_edges(x, triangles_, t)) - rest.rest);
    const double largest = 0.5 * (G[0] + G[1]) + std::hypot(0.5 * (G[0] - G[1]), G[2]);
    for (int k = 0; k < 3; ++k) sum[triangles_(k, t)] += rest.area * largest;
  }
  for (Eigen::Index i = 0; i < sum.size(); ++i)
    if (area_around_[i] > 0) sum[i] /= area_around_[i];
  return sum;
}

}  // namespace pliant
