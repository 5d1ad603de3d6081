// The surface of a part as contact sees it: points all over it, and the lowest points of a field on it,
// found among these and then refined on the surface itself, so that round things roll smoothly.
#pragma once

#include <functional>
#include <vector>

#include <pliant/part/surface.h>

namespace pliant {

class CollisionSurface {
 public:
  explicit CollisionSurface(const Part& part);

  /// What the surface may touch, over points of the body frame.
  struct Field {
    std::function<double(const Vec3<double>&)> height;  ///< m
    /// Cheaper, and zero where the height is: what a search goes down along (m, as far as it is small).
    std::function<VecX<double>(const Eigen::Matrix3Xd&)> descent;
  };
  struct LowPoint {
    Material<double> material;
    Vec3<double> p = Vec3<double>::Zero();  ///< body frame, m
    double height = 0;                      ///< m
  };

  /// All points, body frame.
  Eigen::Matrix3Xd points(const ParameterValues<double>& values) const {
    return part_->s(surface_.material(), values);
  }
  /// The least extent of the part at rest along the axes of its frame, m.
  double thickness() const { return thickness_; }
  /// Points that carry the part on what lies below: the lowest one, and where edges or faces lie flat, the
  /// outermost ones along them; none higher than `most`. heights: of the field at points p. A face has four,
  /// so that boxes stand.
  std::vector<LowPoint> low_points(const ParameterValues<double>& values, const Eigen::Matrix3Xd& p,
                                   const VecX<double>& heights, double most, const Field& field) const;

 private:
  /// Goes down from point number i, no further than to its neighbours.
  LowPoint descend(const ParameterValues<double>& values, Eigen::Index i, const Field& field) const;

  const Part* part_;
  Surface surface_;
  double spacing_;  ///< of the points, as mesh_label() counts
  double thickness_;
};

}  // namespace pliant
