// Overlaps of two triangle meshes: vertices of one mesh behind triangles of the other, and pairs of edges
// that have passed through each other.
#pragma once

#include <array>
#include <vector>

#include <pliant/collision/mesh/contact_mesh.h>
#include <pliant/collision/mesh/obstacle_mesh.h>

namespace pliant {

/// A mesh and the positions of its vertices in the world.
struct PlacedMesh {
  const ContactMesh* mesh;
  Eigen::Matrix3Xd x;  ///< vertices, m
  Eigen::AlignedBox3d box;

  PlacedMesh(const ContactMesh& of, Eigen::Matrix3Xd at);
};

/// A point of a mesh as a weighted mean of up to three vertices; -1 marks an unused entry.
struct MeshPoint {
  std::array<int, 3> vertex{-1, -1, -1};
  Vec3<double> weight = Vec3<double>::UnitX();
};

/// An overlap of two meshes a and b: a point of a, and a point of b.
struct MeshTouch {
  MeshPoint a, b;
  Vec3<double> x;       ///< the overlapping vertex (of a or b), or the point on the edge of a, m, world
  Vec3<double> normal;  ///< unit vector out of b, world
  double gap;           ///< m, negative
};

/// Appends the overlaps of two meshes. The order of the overlaps depends only on the meshes.
void find_touches(const PlacedMesh& a, const PlacedMesh& b, std::vector<MeshTouch>& found);
/// Appends the overlaps of a mesh a with an obstacle b. If a vertex of the mesh is behind the obstacle,
/// MeshTouch::b is not set. Overlaps deeper than `deepest` (m) are ignored, because a vertex that deep may be
/// on the far side of the mesh. A vertex of the mesh overlaps only with triangles whose normal opposes the
/// outward direction of the mesh at the vertex (angle above 90 degrees).
void find_touches(const PlacedMesh& a, const ObstacleMesh& b, double deepest, std::vector<MeshTouch>& found);

}  // namespace pliant
