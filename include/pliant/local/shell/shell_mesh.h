// A triangulated shell at rest: X of its nodes (m) and the triangles, counter-clockwise seen from outside.
#pragma once

#include <pliant/local/nodes.h>

namespace pliant {

class ShellMesh {
 public:
  /// Throws std::invalid_argument when a triangle names a node that is not there, or has no area, or when a
  /// position is not finite; the message names the triangle.
  ShellMesh(Nodes X, Eigen::Matrix3Xi triangles);

  const Nodes& X() const { return X_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  Eigen::Index n_nodes() const { return X_.rows(); }
  Eigen::Index n_triangles() const { return triangles_.cols(); }

  /// Corner 0, 1 or 2 of triangle t.
  Vec3<double> corner(Eigen::Index t, int k) const { return X_.row(triangles_(k, t)); }
  /// Half the cross product of two edges: along the normal, as long as the area.
  Vec3<double> area_vector(Eigen::Index t) const;
  double area(Eigen::Index t) const { return area_vector(t).norm(); }

 private:
  Nodes X_;
  Eigen::Matrix3Xi triangles_;
};

}  // namespace pliant
