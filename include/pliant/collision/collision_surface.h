// The surface of a part as contact sees it: points all over it, and the lowest points of a field on it,
// found among these and then refined on the surface itself, so that round things roll smoothly. Ellipsoids
// need no points over planes and over each other (ellipsoid_points.h).
#pragma once

#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/part/mesh/surface.h>

namespace pliant {

class CollisionSurface {
 public:
  explicit CollisionSurface(const Part& part);

  /// What the surface may touch, over points of the body frame.
  class Field {
   public:
    virtual ~Field() = default;
    virtual double height(const Vec3<double>& p) const = 0;  ///< m
    /// Cheaper, and zero where the height is: what a search goes down along (m, as far as it is small).
    virtual double descent(const Vec3<double>& p) const = 0;
  };
  /// The height over a plane: normal, of length 1, in the body frame; offset: of the frame's origin, m.
  class OverPlane final : public Field {
   public:
    OverPlane(const Vec3<double>& normal, double offset) : normal_(normal), offset_(offset) {}
    double height(const Vec3<double>& p) const override { return p.dot(normal_) + offset_; }
    double descent(const Vec3<double>& p) const override { return height(p); }

   private:
    Vec3<double> normal_;
    double offset_;
  };
  struct LowPoint {
    Material<double> material;
    Vec3<double> p = Vec3<double>::Zero();  ///< body frame, m
    double height = 0;                      ///< m
  };

  /// Of a part that is an ellipsoid at these values: its semi-axes, m.
  std::optional<Vec3<double>> semi_axes(const ParameterValues<double>& values) const;
  /// Of a part that is a box at these values: its half sizes, m.
  std::optional<Vec3<double>> half_sizes(const ParameterValues<double>& values) const;
  /// The point of an ellipsoid in the direction y, of length 1, of its ball; its height is left to the
  /// caller.
  LowPoint ellipsoid_point(const ParameterValues<double>& values, const Vec3<double>& axes,
                           const Vec3<double>& y) const;
  /// Radius of a ball about the frame's origin that the part is in, m.
  double reach(const ParameterValues<double>& values) const;
  /// The least extent of the part at rest along the axes of its frame, m.
  double thickness() const { return thickness_; }

  /// All points, body frame.
  Eigen::Matrix3Xd points(const ParameterValues<double>& values) const {
    return part_->s(laid().surface.material(), values);
  }
  /// Those at rest, and a box about the surface then.
  const Eigen::Matrix3Xd& rest_points() const { return laid().points; }
  const Eigen::AlignedBox3d& rest_box() const { return laid().box; }
  /// Points that carry the part on what lies below: the lowest one, and where edges or faces lie flat, the
  /// outermost ones along them; none higher than `most`. heights: of the field at points p. A face has four,
  /// so that boxes stand.
  std::vector<LowPoint> low_points(const ParameterValues<double>& values, const Eigen::Matrix3Xd& p,
                                   const VecX<double>& heights, double most, const Field& field) const;

 private:
  /// The points, laid when they are first asked for.
  struct Laid {
    Surface surface;
    Eigen::Matrix3Xd points;  ///< at rest
    Eigen::AlignedBox3d box;
    double reach;
    std::vector<Material<double>> few;  ///< that tell the reach of a part that changes
  };
  const Laid& laid() const;
  /// Goes down from point number i, no further than to its neighbours.
  LowPoint descend(const ParameterValues<double>& values, Eigen::Index i, const Field& field) const;

  const Part* part_;
  mutable std::optional<Laid> laid_;
  double spacing_;  ///< of the points, as mesh_label() counts
  double thickness_;
};

}  // namespace pliant
