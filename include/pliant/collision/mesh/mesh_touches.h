// Where two triangle meshes have gone through each other: vertices of one behind triangles of the other, and
// edges across edges.
#pragma once

#include <array>
#include <vector>

#include <pliant/collision/mesh/contact_mesh.h>
#include <pliant/collision/mesh/obstacle_mesh.h>

namespace pliant {

/// A mesh where it is, world.
struct PlacedMesh {
  const ContactMesh* mesh;
  Eigen::Matrix3Xd x;  ///< vertices, m
  Eigen::AlignedBox3d box;

  PlacedMesh(const ContactMesh& of, Eigen::Matrix3Xd at);
};

/// A point of a mesh between vertices, as many as are not -1.
struct MeshPoint {
  std::array<int, 3> vertex{-1, -1, -1};
  Vec3<double> weight = Vec3<double>::UnitX();
};

struct MeshTouch {
  MeshPoint a, b;
  Vec3<double> x;       ///< m
  Vec3<double> normal;  ///< out of b, of length 1
  double gap;           ///< negative, m
};

/// Appends them, in an order that depends on the meshes alone.
void find_touches(const PlacedMesh& a, const PlacedMesh& b, std::vector<MeshTouch>& found);
/// Likewise where b is an obstacle, whose points are not told. What is deeper behind it than this (m) came
/// from elsewhere, and so did what faces the way a triangle does.
void find_touches(const PlacedMesh& a, const ObstacleMesh& b, double deepest, std::vector<MeshTouch>& found);

}  // namespace pliant
