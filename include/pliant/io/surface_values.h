// The values of a quantity (strain or displacement) at the vertices of a part's surface. Pictures colour the
// surface by these values.
#pragma once

#include <optional>

#include <pliant/local/shell/surface_strain.h>
#include <pliant/scene/coloring.h>

namespace pliant {

class SurfaceValues {
 public:
  /// X: vertices at rest, m, body frame, 3 x n. triangles: 3 x m; each column has the indices of three
  /// columns of X.
  SurfaceValues(SurfaceQuantity quantity, Eigen::Matrix3Xd X, const Eigen::Matrix3Xi& triangles);

  /// Returns the values of the n vertices at the positions p (m, body frame, 3 x n): strain (1), or
  /// displacement (m).
  VecX<double> at(const Eigen::Matrix3Xd& p) const;

 private:
  Eigen::Matrix3Xd X_;
  std::optional<SurfaceStrain> strain_;
};

}  // namespace pliant
