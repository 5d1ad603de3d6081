// Function bodies of surface_turn.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/local/solid/corotated.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/mesh/surface_turn.h>

namespace pliant {

namespace detail {

/// Returns two edges and the unit normal of a triangle as columns. The normal of a triangle without area is
/// zero.
inline Mat3<double> triangle_axes(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  Mat3<double> columns;
  columns << b - a, c - a, (b - a).cross(c - a).normalized();
  return columns;
}

}  // namespace detail

PLIANT_INLINE bool linear_on_moving_shape(const Part& part) {
  const LocalDeformation* local = part.local();
  if (local == nullptr || part.n_s() == 0) return false;
  if (local->nodal() == nullptr) return true;
  const auto& energies = local->nodal()->energies();
  return std::any_of(energies.begin(), energies.end(), [](const auto& energy) {
    return energy->of() == NodalEnergy::Of::displacement && !energy->isotropic();
  });
}

PLIANT_INLINE double largest_surface_turn(const Part& part, const VecMax<double>& q_s) {
  const LocalMesh& mesh = part.local()->mesh();
  std::vector<PointJet<double>> now;
  Counters counters;
  part.points(mesh.nodes, q_s, VecMax<double>::Zero(q_s.size()), now, counters);
  double largest = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vec3<int> corner = mesh.triangles.col(t);
    const auto rest = [&](int k) -> Vec3<double> { return mesh.X.row(corner[k]).transpose(); };
    const Mat3<double> before = detail::triangle_axes(rest(0), rest(1), rest(2)),
                       after = detail::triangle_axes(now[at(corner[0])].p, now[at(corner[1])].p,
                                                     now[at(corner[2])].p);
    const double volume = before.determinant();
    if (!(volume > 0) || !(after.determinant() > 0)) continue;
    const double cosine = 0.5 * (nearest_rotation<double>(after * before.inverse()).trace() - 1);
    largest = std::max(largest, std::acos(std::clamp(cosine, -1.0, 1.0)));
  }
  return largest;
}

}  // namespace pliant
