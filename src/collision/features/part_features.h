// The faces, edges and vertices of a solid, with derivatives. A feature maps k = 0, 1 or 2 coordinates s to
// points e(s) of the undeformed solid, and the chain of deformations T maps these to x = T(e). A smooth solid
// is one face without boundary: its points satisfy gauge(e) = 1 (shape/shape.h), and s are distances along
// its tangents. A box has 6 faces, 12 edges and 8 vertices. A cylinder or cone has two end faces, two rims
// and a side.
#pragma once

#include <array>
#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// A point of a feature.
struct FeaturePoint {
  int feature = 0;
  Vec3<double> e = Vec3<double>::Zero();  ///< undeformed position, m
  Eigen::Vector2d s{0, 0};                ///< coordinates; not used for smooth solids
};

/// Value and derivatives of x(s) at a point, body frame. s has the unit m for smooth solids and is without
/// unit for others.
struct FeatureJet {
  int dimension = 0;                      ///< k
  Vec3<double> x = Vec3<double>::Zero();  ///< m
  Eigen::Matrix<double, 3, 2> tangents =
      Eigen::Matrix<double, 3, 2>::Zero();          ///< dx/ds; unused columns are zero
  Mat3<double> second = Mat3<double>::Zero();       ///< d2x/ds1^2, d2x/(ds1 ds2) and d2x/ds2^2
  Vec3<double> normal = Vec3<double>::Zero();       ///< outward unit normal of a face
  std::array<Vec3<double>, 3> inward;               ///< edge: into its faces; vertex: along its edges
  int n_inward = 0;                                 ///< number of these directions; 0 for a face
  Eigen::Matrix<double, 3, 2> undeformed_tangents;  ///< de/ds
  Mat3<double> undeformed_second;                   ///< second derivatives of e, in the order of `second`
};

class PartFeatures {
 public:
  /// Whether the features of a part are known at these values: a box, or a shape with end faces whose rims
  /// are ellipses, or a smooth shape without nearly flat or sharply pointed regions.
  static bool exist(const Part& part, const ParameterValues<double>& values);
  /// part: a part whose features exist (exist()). It must outlive this object.
  PartFeatures(const Part& part, const ParameterValues<double>& values);

  int count() const { return static_cast<int>(features_.size()); }
  int dimension(int feature) const { return features_[static_cast<std::size_t>(feature)].dimension; }
  /// Whether a feature is a surface or curve without boundary.
  bool is_closed(int feature) const;
  bool is_smooth_solid() const { return features_.front().kind == Kind::smooth; }
  /// Returns the middles of patches of about equal size into which a feature is divided, and sets the step of
  /// s between them. The feature must not be a smooth solid. angle: largest turn of the normal over a patch
  /// of an undeformed rim or side, rad.
  std::vector<FeaturePoint> grid(int feature, double angle, Eigen::Vector2d& step) const;

  FeatureJet evaluate(const FeaturePoint& point) const;
  /// Returns the point whose coordinates differ by ds from those of a point. jet: evaluate(point).
  FeaturePoint moved(const FeaturePoint& point, const FeatureJet& jet, const Eigen::Vector2d& ds) const;
  /// Whether a point (body frame, m) is inside the part: its inside-outside function is less than -depth.
  bool contains(const Vec3<double>& x, double depth = 0) const {
    return part_.inside_outside(x, values_) < -depth;
  }
  /// Whether the coordinates of a point are within the boundary of its feature.
  bool is_inside(const FeaturePoint& point) const;

 private:
  /// smooth: a smooth solid; affine: a face, edge or vertex of a box; disc, rim, side: of a solid with end
  /// faces.
  enum class Kind { smooth, affine, disc, rim, side };
  struct Feature {
    Kind kind = Kind::smooth;
    int dimension = 2;
    int end = 0;                                 ///< 0 or 1: the end face of a disc or rim
    Vec3<double> origin = Vec3<double>::Zero();  ///< of kinds affine and disc: point with s = 0, m
    Eigen::Matrix<double, 3, 2> axes =
        Eigen::Matrix<double, 3, 2>::Zero();  ///< of kinds affine and disc: derivative of e by s, m
    std::array<Vec3<double>, 3> outwards{
        Vec3<double>::Zero(), Vec3<double>::Zero(),
        Vec3<double>::Zero()};  ///< of kinds affine and disc: outward normals of the adjacent faces
    int n_outwards = 0;
  };
  struct Rim {
    double a, b, z;  ///< semi-axes and height, m
  };
  void add_box(const Vec3<double>& half);
  void add_round();
  /// Sets the undeformed derivatives of a jet, its inward directions and its normal, all undeformed.
  void evaluate_undeformed(const FeaturePoint& point, FeatureJet& jet) const;
  void evaluate_smooth(const Vec3<double>& e, FeatureJet& jet) const;
  Vec3<double> position(const Feature& feature, const Eigen::Vector2d& s) const;
  Vec3<double> on_rim(int end, double angle, int derivative) const;

  const Part& part_;
  ParameterValues<double> values_;
  std::vector<Feature> features_;
  std::array<Rim, 2> rims_{};
};

}  // namespace pliant
