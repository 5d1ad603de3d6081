// Function bodies of surface.h: the mesh of the surface and its normals.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/math/header_only.h>
#include <pliant/part/mesh/ball_pattern.h>
#include <pliant/part/mesh/surface.h>

namespace pliant {

namespace detail {

/// Cosine of the crease angle of 60 degrees, see set_normals().
inline constexpr double kCreaseCosine = 0.5;

/// Computes the mesh of a torus: a grid with 4 * resolution angles around the tube and 8 * resolution angles
/// around the axis. Appends the angles of each vertex (around the tube, around z, 0), rad, to `places`, and
/// the vertex numbers of each triangle to `triangles`.
inline void torus_surface(int resolution, std::vector<Vec3<double>>& places,
                          std::vector<std::array<int, 3>>& triangles) {
  const int round = 8 * resolution, tube = 4 * resolution;
  for (int j = 0; j < round; ++j)
    for (int i = 0; i < tube; ++i) places.emplace_back(2 * kPi * i / tube, 2 * kPi * j / round, 0);
  auto at = [&](int i, int j) { return (j % round) * tube + i % tube; };
  for (int j = 0; j < round; ++j)
    for (int i = 0; i < tube; ++i) {
      triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
    }
}

/// Sets the normals of a mesh from the normals of its vertices. If the normal of a triangle and the normal of
/// one of its vertices differ by more than the crease angle, this corner gets the normal of the triangle.
inline void set_normals(TriangleMesh& mesh, std::vector<Vec3<double>> normals) {
  mesh.corners = mesh.triangles;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vec3<double> a = mesh.x.col(mesh.triangles(0, t)), b = mesh.x.col(mesh.triangles(1, t)),
                       c = mesh.x.col(mesh.triangles(2, t));
    const Vec3<double> face = (b - a).cross(c - a);
    const double area = face.norm();
    if (area == 0) continue;
    int added = -1;
    for (int k = 0; k < 3; ++k) {
      const Vec3<double>& n = normals[static_cast<std::size_t>(mesh.triangles(k, t))];
      if (n.dot(face) >= kCreaseCosine * area) continue;
      if (added < 0) {
        added = static_cast<int>(normals.size());
        normals.push_back(face / area);
      }
      mesh.corners(k, t) = added;
    }
  }
  mesh.normals.resize(3, static_cast<Eigen::Index>(normals.size()));
  for (std::size_t i = 0; i < normals.size(); ++i)
    mesh.normals.col(static_cast<Eigen::Index>(i)) = normals[i];
}

}  // namespace detail

PLIANT_INLINE Surface::Surface(const Part& part, int resolution, const std::array<int, 3>& spacing) {
  if (resolution < 1 || resolution > 512)
    throw std::invalid_argument("surface resolution " + std::to_string(resolution) +
                                " must be from 1 to 512");
  const ParameterValues<double> rest = part.parameters().rest();
  const ShapeInterface& shape = part.shape();
  std::vector<std::array<int, 3>> triangles;
  if (shape.mesh() == MeshPattern::ball) {
    const BallSurface ball(resolution, spacing);
    for (const LatticePoint& p : ball.points) places_.push_back(ball_direction(p));
    triangles = ball.triangles;
  } else {
    detail::torus_surface(resolution, places_, triangles);
  }
  for (const Vec3<double>& place : places_) material_.push_back(shape.mesh_label(place, rest.b.data()));
  triangles_.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      triangles_(k, static_cast<Eigen::Index>(t)) = triangles[t][static_cast<std::size_t>(k)];
}

PLIANT_INLINE int Surface::resolution_for(const Part& part, int triangles) {
  const double triangles_at_one = part.shape().mesh() == MeshPattern::ball ? 48.0 : 64.0;
  return std::clamp(static_cast<int>(std::lround(std::sqrt(triangles / triangles_at_one))), 1, 512);
}

PLIANT_INLINE TriangleMesh Surface::body_mesh(const Part& part, const ParameterValues<double>& values) const {
  TriangleMesh mesh;
  mesh.x = part.s(material_, values);
  mesh.triangles = triangles_;
  detail::set_normals(mesh, part.normals(material_, values));
  return mesh;
}

PLIANT_INLINE SurfaceNodes surface_nodes(const LocalMesh& mesh) {
  // Position of each node in surface.node; -1 for a node inside the body.
  std::vector<int> number(mesh.nodes.size(), -1);
  for (const int node : mesh.triangles.reshaped()) number[static_cast<std::size_t>(node)] = 0;
  SurfaceNodes surface;
  for (std::size_t k = 0; k < number.size(); ++k) {
    if (number[k] < 0) continue;
    number[k] = static_cast<int>(surface.node.size());
    surface.node.push_back(static_cast<int>(k));
  }
  surface.triangles =
      mesh.triangles.unaryExpr([&](int node) { return number[static_cast<std::size_t>(node)]; });
  return surface;
}

PLIANT_INLINE Eigen::Matrix3Xd SurfaceNodes::of(const Eigen::Ref<const Nodes>& all) const {
  Eigen::Matrix3Xd x(3, static_cast<Eigen::Index>(node.size()));
  for (Eigen::Index k = 0; k < x.cols(); ++k)
    x.col(k) = all.row(node[static_cast<std::size_t>(k)]).transpose();
  return x;
}

PLIANT_INLINE TriangleMesh node_mesh(const Eigen::Matrix3Xi& triangles, Eigen::Matrix3Xd x) {
  TriangleMesh mesh;
  mesh.x = std::move(x);
  mesh.triangles = triangles;
  std::vector<Vec3<double>> normals(static_cast<std::size_t>(mesh.x.cols()), Vec3<double>::Zero());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const std::array<Vec3<double>, 3> corner{
        mesh.x.col(mesh.triangles(0, t)), mesh.x.col(mesh.triangles(1, t)), mesh.x.col(mesh.triangles(2, t))};
    for (std::size_t k = 0; k < 3; ++k) {
      // The weight of a triangle is its angle at the vertex. The normals of a grid then do not depend on the
      // choice of its diagonals.
      const Vec3<double> e1 = corner[(k + 1) % 3] - corner[k], e2 = corner[(k + 2) % 3] - corner[k];
      const Vec3<double> normal = e1.cross(e2);
      const double area = normal.norm();
      if (area > 0)
        normals[static_cast<std::size_t>(mesh.triangles(static_cast<Eigen::Index>(k), t))] +=
            std::atan2(area, e1.dot(e2)) / area * normal;
    }
  }
  for (Vec3<double>& n : normals) n.normalize();
  detail::set_normals(mesh, std::move(normals));
  return mesh;
}

PLIANT_INLINE TriangleMesh Surface::world_mesh(const Part& part, const ParameterValues<double>& values,
                                               const Vec3<double>& c, const Eigen::Quaterniond& R) const {
  TriangleMesh mesh = body_mesh(part, values);
  const Mat3<double> rotation = R.toRotationMatrix();
  mesh.x = (rotation * mesh.x).colwise() + c;
  mesh.normals = rotation * mesh.normals;
  return mesh;
}

PLIANT_INLINE double enclosed_volume(const TriangleMesh& mesh) {
  double six_volumes = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vec3<double> a = mesh.x.col(mesh.triangles(0, t)), b = mesh.x.col(mesh.triangles(1, t)),
                       c = mesh.x.col(mesh.triangles(2, t));
    six_volumes += a.dot(b.cross(c));
  }
  return six_volumes / 6;
}

}  // namespace pliant
