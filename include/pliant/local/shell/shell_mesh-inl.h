#include <pliant/local/shell/shell_mesh.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <Eigen/Geometry>

namespace pliant {

namespace {
/// Twice the area of a triangle with less than this part of its longest edge squared is rounding.
constexpr double kNoArea = 1e-12;
}  // namespace

ShellMesh::ShellMesh(Nodes X, Eigen::Matrix3Xi triangles)
    : X_(std::move(X)), triangles_(std::move(triangles)) {
  if (n_triangles() == 0) throw std::invalid_argument("the shell has no triangles");
  for (Eigen::Index i = 0; i < n_nodes(); ++i)
    if (!X_.row(i).allFinite())
      throw std::invalid_argument("node " + std::to_string(i) + " of the shell has no finite position");
  for (Eigen::Index t = 0; t < n_triangles(); ++t) {
    const std::string name = "triangle " + std::to_string(t) + " of the shell";
    for (int k = 0; k < 3; ++k)
      if (triangles_(k, t) < 0 || triangles_(k, t) >= n_nodes())
        throw std::invalid_argument(name + " names node " + std::to_string(triangles_(k, t)) +
                                    "; there are " + std::to_string(n_nodes()));
    double longest = 0;
    for (int k = 0; k < 3; ++k)
      longest = std::max(longest, (corner(t, (k + 1) % 3) - corner(t, k)).squaredNorm());
    if (!(2 * area(t) > kNoArea * longest)) throw std::invalid_argument(name + " has no area");
  }
}

Vec3<double> ShellMesh::area_vector(Eigen::Index t) const {
  const Vec3<double> a = corner(t, 0);
  return 0.5 * (corner(t, 1) - a).cross(corner(t, 2) - a);
}

}  // namespace pliant
