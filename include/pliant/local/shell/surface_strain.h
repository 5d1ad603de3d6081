// Strain of a triangulated surface for pictures: the largest principal value of Green's strain
//   G = (F^T F - 1)/2
// from rest to the current positions. A value of 0.1 is an elongation of 9.5 %. The value at a vertex is the
// mean over its triangles, weighted by their areas at rest.
#pragma once

#include <vector>

#include <pliant/math/types.h>

namespace pliant {

class SurfaceStrain {
 public:
  /// X: positions of the vertices at rest, m, one column for each vertex. triangles: three vertex numbers in
  /// each column. Triangles without area at rest are ignored.
  SurfaceStrain(const Eigen::Matrix3Xd& X, Eigen::Matrix3Xi triangles);

  /// Returns the strain at each vertex; 0 at a vertex without triangles that have an area at rest. x: current
  /// positions of the vertices, m.
  VecX<double> at(const Eigen::Matrix3Xd& x) const;

 private:
  struct Triangle {
    Vec3<double> rest;    // |e_k|^2/2 at rest, m^2
    Mat3<double> G_of_q;  // (G_11, G_22, G_12) in the plane of the triangle at rest = G_of_q q
    double area;          // at rest, m^2; 0: the triangle is ignored
  };

  Eigen::Matrix3Xi triangles_;
  std::vector<Triangle> rest_;
  VecX<double> area_around_;  // sum of the areas of each vertex's triangles, m^2
};

}  // namespace pliant
