#include <pliant/io/surface_values.h>

#include <utility>

namespace pliant {

SurfaceValues::SurfaceValues(SurfaceQuantity quantity, Eigen::Matrix3Xd X, const Eigen::Matrix3Xi& triangles)
    : X_(std::move(X)) {
  if (quantity == SurfaceQuantity::strain) strain_.emplace(X_, triangles);
}

VecX<double> SurfaceValues::at(const Eigen::Matrix3Xd& p) const {
  return strain_ ? strain_->at(p) : VecX<double>((p - X_).colwise().norm());
}

}  // namespace pliant
