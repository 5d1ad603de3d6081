// Meshes for the tests and benches of shells: a sphere from the icosahedron, an irregular flat sheet.
#pragma once

#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/local/shell/shell_mesh.h>

namespace pliant::test {

inline ShellMesh shell_mesh(const std::vector<Vec3<double>>& X,
                            const std::vector<std::array<int, 3>>& triangles) {
  Nodes nodes(static_cast<Eigen::Index>(X.size()), 3);
  for (std::size_t i = 0; i < X.size(); ++i) nodes.row(static_cast<Eigen::Index>(i)) = X[i].transpose();
  Eigen::Matrix3Xi corners(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      corners(k, static_cast<Eigen::Index>(t)) = triangles[t][static_cast<std::size_t>(k)];
  return ShellMesh(nodes, corners);
}

/// Returns a sphere about the origin. The triangles of an icosahedron are split into four, `levels` times.
inline ShellMesh icosphere(int levels, double radius) {
  const double g = 0.5 * (1 + std::sqrt(5.0));
  std::vector<Vec3<double>> X{{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                              {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  std::vector<std::array<int, 3>> triangles{{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                            {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                            {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                            {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::pair<int, int>, int> middles;
    auto middle = [&](int a, int b) {
      const auto [at, fresh] = middles.try_emplace(std::minmax(a, b), static_cast<int>(X.size()));
      if (fresh)
        X.emplace_back((X[static_cast<std::size_t>(a)] + X[static_cast<std::size_t>(b)]).normalized() *
                       X[static_cast<std::size_t>(a)].norm());
      return at->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& [a, b, c] : triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    triangles = finer;
  }
  for (Vec3<double>& x : X) x *= radius / x.norm();
  return shell_mesh(X, triangles);
}

/// Returns a mesh of a rectangle a x b in the plane z = 0 about the origin, with n x m irregular cells of two
/// triangles each. Nodes of the boundary are on the straight sides of the rectangle.
template <class Draws>
ShellMesh irregular_sheet(int n, int m, double a, double b, Draws&& draws) {
  std::vector<Vec3<double>> X;
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j <= m; ++j)
    for (int i = 0; i <= n; ++i) {
      const double inside_x = i > 0 && i < n ? 1 : 0, inside_y = j > 0 && j < m ? 1 : 0;
      X.emplace_back(a * ((i + inside_x * draws.uniform(-0.25, 0.25)) / n - 0.5),
                     b * ((j + inside_y * draws.uniform(-0.25, 0.25)) / m - 0.5), 0);
    }
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) {
      const int p = j * (n + 1) + i, q = p + 1, r = p + n + 2, s = p + n + 1;
      if (draws.uniform(0, 1) < 0.5)
        triangles.insert(triangles.end(), {{p, q, r}, {p, r, s}});
      else
        triangles.insert(triangles.end(), {{p, q, s}, {q, r, s}});
    }
  return shell_mesh(X, triangles);
}

/// Returns the solid angle of a triangle seen from the origin (Van Oosterom & Strackee 1983).
inline double solid_angle(const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const double la = a.norm(), lb = b.norm(), lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

/// Returns the area of each node on the sphere: a third of each adjacent spherical triangle. The sum is 4 pi
/// r^2.
inline VecX<double> sphere_areas(const ShellMesh& mesh) {
  VecX<double> area = VecX<double>::Zero(mesh.n_nodes());
  for (Eigen::Index t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k)
      area[mesh.triangles()(k, t)] += solid_angle(mesh.corner(t, 0), mesh.corner(t, 1), mesh.corner(t, 2)) *
                                      mesh.corner(t, k).squaredNorm() / 3;
  return area;
}

/// Returns a third of the area of the adjacent triangles for each node.
inline VecX<double> node_areas(const ShellMesh& mesh) {
  VecX<double> area = VecX<double>::Zero(mesh.n_nodes());
  for (Eigen::Index t = 0; t < mesh.n_triangles(); ++t)
    for (int k = 0; k < 3; ++k) area[mesh.triangles()(k, t)] += mesh.area(t) / 3;
  return area;
}

/// Returns local coordinates whose x, y and z entries at node i are all a[i].
inline VecX<double> thrice(const VecX<double>& a) {
  VecX<double> all(3 * a.size());
  all << a, a, a;
  return all;
}

/// Returns local coordinates whose vector at each node is f(X), with the position X of the node.
template <class F>
VecX<double> field(const ShellMesh& mesh, F&& f) {
  const Eigen::Index n = mesh.n_nodes();
  VecX<double> x(3 * n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vec3<double> value = f(Vec3<double>(mesh.X().row(i)));
    for (int c = 0; c < 3; ++c) x[c * n + i] = value[c];
  }
  return x;
}

}  // namespace pliant::test
