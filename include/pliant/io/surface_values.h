// What colours of a part's surface tell: a quantity of its vertices, which come in the frame of the part.
#pragma once

#include <optional>

#include <pliant/local/shell/surface_strain.h>
#include <pliant/scene/coloring.h>

namespace pliant {

class SurfaceValues {
 public:
  /// X: the vertices at rest, m, one a column.
  SurfaceValues(SurfaceQuantity quantity, Eigen::Matrix3Xd X, const Eigen::Matrix3Xi& triangles);

  /// Of each vertex, with the vertices at p.
  VecX<double> at(const Eigen::Matrix3Xd& p) const;

 private:
  Eigen::Matrix3Xd X_;
  std::optional<SurfaceStrain> strain_;
};

}  // namespace pliant
