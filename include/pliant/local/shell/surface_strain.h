// How much a surface is stretched, for pictures: Green's strain G = (F^T F - 1)/2 of each triangle from rest
// to now, of which the largest principal value counts; +0.1 is a stretch by 9.5 %. A vertex has the mean of
// the triangles around it, weighted by their areas at rest.
#pragma once

#include <vector>

#include <pliant/math/types.h>

namespace pliant {

class SurfaceStrain {
 public:
  /// X: vertices at rest, m, one a column. Triangles without area at rest count for nothing.
  SurfaceStrain(const Eigen::Matrix3Xd& X, Eigen::Matrix3Xi triangles);

  /// Of every vertex, with the vertices at x.
  VecX<double> at(const Eigen::Matrix3Xd& x) const;

 private:
  struct Triangle {
    Vec3<double> rest;         // half the squares of its edges
    Mat3<double> along_edges;  // (G_11, G_22, G_12) in the plane of the triangle at rest, from their changes
    double area;               // m^2; 0 of one without
  };

  Eigen::Matrix3Xi triangles_;
  std::vector<Triangle> rest_;
  VecX<double> area_around_;  // of each vertex
};

}  // namespace pliant
