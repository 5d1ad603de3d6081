// The surface of a part as a triangle mesh without poles or seams. The vertices of balls come from the
// directions of ball_pattern.h. The vertices of tori form a grid of the two angles.
#pragma once

#include <array>
#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// Material points and triangles that cover the surface of a part, chosen once at the rest shape.
class Surface {
 public:
  /// resolution: for a ball the number of edges along an eighth of a great circle, from 1 to 512. A ball has
  /// 24 resolution^2 + 2 vertices and 48 resolution^2 triangles for a spacing of 1. A torus has 4 resolution
  /// vertices around the tube and 8 resolution around the axis. Throws std::invalid_argument for a resolution
  /// outside 1 to 512. spacing: for a ball, see BallSurface.
  Surface(const Part& part, int resolution, const std::array<int, 3>& spacing = {1, 1, 1});

  const std::vector<Material<double>>& material() const { return material_; }
  /// The argument g of ShapeInterface::mesh_label() for each material point: a direction or two angles.
  const std::vector<Vec3<double>>& places() const { return places_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  /// Returns the resolution, from 1 to 512, whose number of triangles is about the given number.
  static int resolution_for(const Part& part, int triangles);

  /// Returns the mesh at these values of the parameters in the body frame, with normals.
  TriangleMesh body_mesh(const Part& part, const ParameterValues<double>& values) const;
  /// Returns body_mesh() transformed to the world, for a frame at c (m) with orientation R (body to world).
  TriangleMesh world_mesh(const Part& part, const ParameterValues<double>& values, const Vec3<double>& c,
                          const Eigen::Quaterniond& R) const;

 private:
  std::vector<Material<double>> material_;
  std::vector<Vec3<double>> places_;
  Eigen::Matrix3Xi triangles_;
};

/// The nodes on the surface of a LocalMesh, in the order of this mesh.
struct SurfaceNodes {
  std::vector<int> node;
  Eigen::Matrix3Xi triangles;  ///< indices into `node`, counter-clockwise seen from outside

  /// Returns the values at the surface nodes, one column for each surface node. all: one row for each node of
  /// the mesh.
  Eigen::Matrix3Xd of(const Eigen::Ref<const Nodes>& all) const;
};
/// Returns the surface nodes of a mesh.
SurfaceNodes surface_nodes(const LocalMesh& mesh);

/// Returns a mesh with vertices x (3 x n, m). The normal of a vertex is the mean of the normals of the
/// adjacent triangles, weighted by the angles of these triangles at the vertex.
TriangleMesh node_mesh(const Eigen::Matrix3Xi& triangles, Eigen::Matrix3Xd x);

/// Returns the volume that a closed mesh encloses, m^3.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace pliant
