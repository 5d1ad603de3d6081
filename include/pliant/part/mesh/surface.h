// The surface of a part as a triangle mesh (design 1.1): laid from directions, without poles or seams. Balls
// are covered by a cube whose upper and lower faces are bent to concentric rings, so that rims, edges and
// coordinate planes fall on mesh lines; tori by a grid of the two angles.
#pragma once

#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// Which material points and triangles cover a part; laid once, at the rest shape.
class Surface {
 public:
  /// resolution: edges along an eighth of a great circle, at least 1. A ball has 24 resolution^2 + 2 vertices
  /// and 48 resolution^2 triangles; a torus 32 resolution^2 vertices. Throws std::invalid_argument outside
  /// [1, 512].
  Surface(const Part& part, int resolution);

  const std::vector<Material<double>>& material() const { return material_; }
  /// Where ShapeFace::mesh_label() took each of them from.
  const std::vector<Vec3<double>>& places() const { return places_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  /// Edges along an eighth of a circle that give about this many triangles.
  static int resolution_for(const Part& part, int triangles);

  /// The mesh in the body frame, at these values, with its normals.
  TriangleMesh body_mesh(const Part& part, const ParameterValues<double>& values) const;
  /// The mesh in the world, with the frame at c and R.
  TriangleMesh world_mesh(const Part& part, const ParameterValues<double>& values, const Vec3<double>& c,
                          const Eigen::Quaterniond& R) const;

 private:
  std::vector<Material<double>> material_;
  std::vector<Vec3<double>> places_;
  Eigen::Matrix3Xi triangles_;
};

/// The nodes on the surface of a part that deforms locally, in their order.
struct SurfaceNodes {
  std::vector<int> node;
  Eigen::Matrix3Xi triangles;  ///< of these nodes, counter-clockwise from outside

  /// The rows of these nodes among those of all, one a column.
  Eigen::Matrix3Xd of(const Eigen::Ref<const Nodes>& all) const;
};
SurfaceNodes surface_nodes(const LocalMesh& mesh);

/// A mesh whose normals are those of the triangles around a vertex.
TriangleMesh node_mesh(const Eigen::Matrix3Xi& triangles, Eigen::Matrix3Xd x);

/// Volume enclosed by a closed mesh, m^3.
double enclosed_volume(const TriangleMesh& mesh);

}  // namespace pliant
