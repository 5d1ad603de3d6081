// The surface of a part as a triangle mesh. The vertices come from directions, so that the mesh has no poles
// or seams. Balls use the pattern of ball_pattern.h; tori use a grid of the two angles.
#pragma once

#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// The material points and triangles that cover a part, chosen once at the rest shape.
class Surface {
 public:
  /// resolution: edges along an eighth of a great circle, from 1 to 512. A ball has 24 resolution^2 + 2
  /// vertices and 48 resolution^2 triangles. A torus has 4 resolution points around the tube and 8 resolution
  /// around the axis. Throws std::invalid_argument for another resolution.
  Surface(const Part& part, int resolution);

  const std::vector<Material<double>>& material() const { return material_; }
  /// The direction or pair of angles of each material point, the argument of ShapeInterface::mesh_label().
  const std::vector<Vec3<double>>& places() const { return places_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  /// Returns the resolution that gives about this number of triangles, from 1 to 512.
  static int resolution_for(const Part& part, int triangles);

  /// Returns the mesh at these values in the body frame, with normals.
  TriangleMesh body_mesh(const Part& part, const ParameterValues<double>& values) const;
  /// Returns the mesh at these values in the world, for a frame at c (m) with orientation R.
  TriangleMesh world_mesh(const Part& part, const ParameterValues<double>& values, const Vec3<double>& c,
                          const Eigen::Quaterniond& R) const;

 private:
  std::vector<Material<double>> material_;
  std::vector<Vec3<double>> places_;
  Eigen::Matrix3Xi triangles_;
};

/// The nodes on the surface of a local mesh, in the order of that mesh.
struct SurfaceNodes {
  std::vector<int> node;
  Eigen::Matrix3Xi triangles;  ///< indices into `node`, counter-clockwise seen from outside

  /// Returns the values at these nodes, one column for each. all: one row for each node of the mesh.
  Eigen::Matrix3Xd of(const Eigen::Ref<const Nodes>& all) const;
};
/// Returns the surface nodes of a mesh.
SurfaceNodes surface_nodes(const LocalMesh& mesh);

/// Returns a mesh with vertices x (m). The normal of a vertex is the mean of the normals of the triangles
/// around it, weighted by their angles there.
TriangleMesh node_mesh(const Eigen::Matrix3Xi& triangles, Eigen::Matrix3Xd x);

/// Returns the volume enclosed by a closed mesh, m^3.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace pliant
