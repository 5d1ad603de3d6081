// Meshes on the parameter rectangle.
#include <pliant/part/mesh/parameter_mesh.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace pliant {

namespace {

struct Corner {
  int node;
  double u, v;
};
using Triangle = std::array<Corner, 3>;

/// Returns x + 2 pi n with the integer n for which the result is nearest to `to`.
double near(double x, double to) {
  return x + 2 * kPi * std::round((to - x) / (2 * kPi));
}

/// Returns twice the area of a triangle on the rectangle. The area is positive if the triangle is
/// counter-clockwise in the plane (v, u).
double twice_area(const Triangle& t) {
  return (t[1].v - t[0].v) * (t[2].u - t[0].u) - (t[1].u - t[0].u) * (t[2].v - t[0].v);
}

}  // namespace

ParameterMesh parameter_mesh(const LocalMesh& mesh) {
  // On a torus, u goes around the tube, so that cos u is negative at some node. A torus has no poles.
  const bool poles = std::none_of(mesh.nodes.begin(), mesh.nodes.end(),
                                  [](const Material<double>& m) { return m.cu.x < 0; });
  std::vector<Triangle> all;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    Triangle corners;  // the first corner is the pole, if there is one
    int first = 0;
    for (int k = 0; k < 3; ++k)
      if (poles && mesh.nodes[static_cast<std::size_t>(mesh.triangles(k, t))].cu.x == 0) first = k;
    for (int k = 0; k < 3; ++k) {
      const int node = mesh.triangles((first + k) % 3, t);
      const MaterialAngles at = angles(mesh.nodes[static_cast<std::size_t>(node)]);
      corners[static_cast<std::size_t>(k)] = {node, at.u, at.v};
    }
    auto& [a, b, c] = corners;
    c.u = near(c.u, b.u);
    a.u = near(a.u, b.u);
    c.v = near(c.v, b.v);
    if (poles && mesh.nodes[static_cast<std::size_t>(a.node)].cu.x == 0) {
      a.v = b.v;
      all.push_back({a, c, {a.node, a.u, c.v}});
    } else {
      a.v = near(a.v, b.v);
    }
    all.push_back(corners);
  }
  const auto n = static_cast<Eigen::Index>(all.size());
  ParameterMesh flat{static_cast<Eigen::Index>(mesh.nodes.size()), {}, {}};
  flat.triangles.resize(3, n);
  flat.uv.resize(2, 3 * n);
  for (Eigen::Index t = 0; t < n; ++t) {
    const Triangle& triangle = all[static_cast<std::size_t>(t)];
    if (!(twice_area(triangle) > 0))
      throw std::invalid_argument(
          "some triangles of its mesh are degenerate or inverted on the parameter rectangle (u, v); "
          "expected exponents nearer to 1, or the law over the surface, \"loaded_membrane\"");
    for (int k = 0; k < 3; ++k) {
      const Corner& corner = triangle[static_cast<std::size_t>(k)];
      flat.triangles(k, t) = corner.node;
      flat.uv.col(3 * t + k) << corner.u, corner.v;
    }
  }
  return flat;
}

}  // namespace pliant
