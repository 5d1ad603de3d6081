// Function bodies of shell_mesh.h.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include <pliant/local/shell/shell_mesh.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {
/// A triangle is rejected as flat if twice its area is at most this fraction of the square of its longest
/// edge. The computed area is then a rounding error.
inline constexpr double kShellFlatTriangle = 1e-12;
}  // namespace detail

PLIANT_INLINE ShellMesh::ShellMesh(Nodes X, Eigen::Matrix3Xi triangles)
    : X_(std::move(X)), triangles_(std::move(triangles)) {
  if (n_triangles() == 0) throw std::invalid_argument("the shell has no triangles");
  for (Eigen::Index i = 0; i < n_nodes(); ++i)
    if (!X_.row(i).allFinite())
      throw std::invalid_argument("the position of node " + std::to_string(i) +
                                  " of the shell is not finite");
  for (Eigen::Index t = 0; t < n_triangles(); ++t) {
    const std::string name = "triangle " + std::to_string(t) + " of the shell";
    for (int k = 0; k < 3; ++k)
      if (triangles_(k, t) < 0 || triangles_(k, t) >= n_nodes())
        throw std::invalid_argument(name + " refers to node " + std::to_string(triangles_(k, t)) +
                                    "; the shell has nodes 0 to " + std::to_string(n_nodes() - 1));
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (corner(t, (k + 1) % 3) - corner(t, k)).squaredNorm());
    if (!(2 * area(t) > detail::kShellFlatTriangle * longest))
      throw std::invalid_argument(name + " has no area");
  }
}

PLIANT_INLINE Vec3<double> ShellMesh::area_vector(Eigen::Index t) const {
  const Vec3<double> a = corner(t, 0);
  return 0.5 * (corner(t, 1) - a).cross(corner(t, 2) - a);
}

}  // namespace pliant
