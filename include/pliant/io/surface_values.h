// The quantity of the vertices of a part's surface by which pictures colour it.
#pragma once

#include <optional>

#include <pliant/local/shell/surface_strain.h>
#include <pliant/scene/coloring.h>

namespace pliant {

class SurfaceValues {
 public:
  /// X: vertices at rest, m, body frame, 3 x n. triangles: three columns of X each.
  SurfaceValues(SurfaceQuantity quantity, Eigen::Matrix3Xd X, const Eigen::Matrix3Xi& triangles);

  /// Returns the value of each vertex for vertices at p (m, body frame, 3 x n).
  VecX<double> at(const Eigen::Matrix3Xd& p) const;

 private:
  Eigen::Matrix3Xd X_;
  std::optional<SurfaceStrain> strain_;
};

}  // namespace pliant
