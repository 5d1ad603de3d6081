// A triangulated shell at rest: positions X of its nodes (m) and its triangles. The corners of a triangle run
// counter-clockwise when seen from outside.
#pragma once

#include <pliant/local/nodes.h>

namespace pliant {

class ShellMesh {
 public:
  /// Throws std::invalid_argument if there is no triangle, if a triangle refers to an unknown node or has no
  /// area, or if a position is not finite. The message gives the number of the triangle or node.
  /// X: one row for each node, m. triangles: three node numbers in each column.
  ShellMesh(Nodes X, Eigen::Matrix3Xi triangles);

  const Nodes& X() const { return X_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  Eigen::Index n_nodes() const { return X_.rows(); }
  Eigen::Index n_triangles() const { return triangles_.cols(); }

  /// Returns the position of corner k = 0, 1 or 2 of triangle t, m.
  Vec3<double> corner(Eigen::Index t, int k) const { return X_.row(triangles_(k, t)); }
  /// Returns the outward normal of triangle t times its area, m^2.
  Vec3<double> area_vector(Eigen::Index t) const;
  double area(Eigen::Index t) const { return area_vector(t).norm(); }

 private:
  Nodes X_;
  Eigen::Matrix3Xi triangles_;
};

}  // namespace pliant
