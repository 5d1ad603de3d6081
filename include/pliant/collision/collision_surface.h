// The surface of a part for contact search: sample points all over the surface, and the lowest points of the
// surface over a plane or another part. The search starts from sample points and continues on the exact
// surface, so that round parts roll smoothly. Ellipsoids over planes and over each other need no sample
// points (ellipsoid_points.h).
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/part/mesh/surface.h>

namespace pliant {

struct PartPatches;

class CollisionSurface {
 public:
  explicit CollisionSurface(const Part& part);
  ~CollisionSurface();

  /// A height over a plane or over another part, as a function of points of the body frame.
  class Field {
   public:
    virtual ~Field() = default;
    virtual double height(const Vec3<double>& p) const = 0;  ///< m
    /// Returns the value of a cheaper function that is zero where height() is zero, m. The search minimises
    /// this function.
    virtual double descent(const Vec3<double>& p) const = 0;
  };
  /// The height over a plane. normal: unit vector, body frame; offset: height of the origin of the frame, m.
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

  /// Returns the semi-axes (m) if the part is an ellipsoid at these values.
  std::optional<Vec3<double>> semi_axes(const ParameterValues<double>& values) const;
  /// Returns the half sizes (m) if the part is a box at these values.
  std::optional<Vec3<double>> half_sizes(const ParameterValues<double>& values) const;
  /// Returns the point with p = axes * y (entry by entry) of an ellipsoid; y: unit vector. The caller sets
  /// the height.
  LowPoint ellipsoid_point(const ParameterValues<double>& values, const Vec3<double>& axes,
                           const Vec3<double>& y) const;
  /// Returns the radius of a ball that is centred at the origin of the frame and contains the part, m. If the
  /// part has dynamic parameters and is no ellipsoid, the radius is estimated from few points.
  double reach(const ParameterValues<double>& values) const;
  /// The least extent of the part at rest along the axes of its frame, m.
  double thickness() const { return thickness_; }

  /// Computes all sample points: one column for each, body frame, m.
  Eigen::Matrix3Xd points(const ParameterValues<double>& values) const {
    return part_->s(samples().surface.material(), values);
  }
  /// Sample points of the rest shape, and a box that contains the surface of the rest shape, body frame, m.
  const Eigen::Matrix3Xd& rest_points() const { return samples().points; }
  const Eigen::AlignedBox3d& rest_box() const { return samples().box; }
  /// Returns the faces, edges and vertices of the rest shape (src/collision/features), or nullptr if they are
  /// not known.
  const PartPatches* rest_patches() const;
  /// Returns the points that support the part: the lowest point, and the outermost points of a level edge
  /// (two) or of a level face (about four), so that a box stands on its corners. No point is higher than
  /// max_gap (m). p: the sample points, as columns in the body frame, m. heights: field.height() at each
  /// sample point, m.
  std::vector<LowPoint> low_points(const ParameterValues<double>& values, const Eigen::Matrix3Xd& p,
                                   const VecX<double>& heights, double max_gap, const Field& field) const;

 private:
  /// Sample points, computed at the first call of samples().
  struct Samples {
    Surface surface;
    Eigen::Matrix3Xd points;  ///< of the rest shape, body frame, m
    Eigen::AlignedBox3d box;
    double reach;
    std::vector<Material<double>> coarse;  ///< points that estimate reach() of a part with dynamic parameters
  };
  const Samples& samples() const;
  /// Minimises field.descent() from sample point i. The search stays within one spacing_ of this point in
  /// each coordinate, but within two in the second coordinate of a chart of latitude and longitude.
  LowPoint descend(const ParameterValues<double>& values, Eigen::Index i, const Field& field) const;

  const Part* part_;
  mutable std::optional<Samples> samples_;
  mutable std::unique_ptr<PartPatches> patches_;  ///< computed at the first call of rest_patches()
  mutable bool patches_known_ = false;
  /// Unit of the search, rad: twice the angle between neighbouring sample points (MeshPattern::ball); on a
  /// torus the angle between neighbours around the tube.
  double spacing_;
  double thickness_;
};

}  // namespace pliant
