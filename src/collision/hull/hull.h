// The convex hull of a part in its body frame, from the support function of its shape (shape/shape.h). The
// chain is the product of the global deformations of a part. If it is affine (shear), x = F e, the support
// point in the direction m is F times the support point of the shape in the direction F^T m. With other
// chains Newton's method finds the support points (curved_hull.h).
#pragma once

#include <optional>
#include <vector>

#include "curved_hull.h"

namespace pliant {

/// Largest number of points that represent the rim of an end face.
inline constexpr int kMaxRimPoints = 8;

/// Returns the distance below which two contact points of a part are merged, m. thickness: least extent of
/// the part, m.
double one_point_distance(double thickness);

class Hull {
 public:
  /// Returns whether the chain of a part is affine for all values of its parameters.
  static bool is_affine(const Part& part);
  /// Returns whether the support points of a part are known at these values: its shape has a support
  /// function, and the chain is affine or CurvedHull::exists().
  static bool exists(const Part& part, const ParameterValues<double>& values);
  /// Returns whether a part is convex, so that it equals its hull. The hull must exist.
  static bool is_convex(const Part& part, const ParameterValues<double>& values);
  /// convex: the part is convex, or is treated as convex. unknown: the part may be non-convex.
  enum class Convexity { convex, unknown };
  /// part: a part whose hull exists. part and values must outlive this object. If the convexity is unknown
  /// and the chain is not affine, touching_points() searches from several starts.
  Hull(const Part& part, const ParameterValues<double>& values, Convexity convexity);

  /// Whether the part is convex, or is treated as convex.
  bool is_convex() const { return convexity_ == Convexity::convex; }
  int pieces() const { return shape_->hull_pieces(); }
  /// Whether a piece has nearly flat regions, other than end faces.
  bool has_flat_regions() const { return shape_->has_flat_regions(a_); }
  bool has_end_faces() const { return shape_->has_end_faces(); }
  /// The largest half extent of the part at rest, m.
  double size() const { return size_; }
  /// Returns the point (m) of a piece that is farthest in the direction m.
  Vec3<double> support(const Vec3<double>& m, int piece) const;
  /// Returns the point (m) of the hull that is farthest in the direction m.
  Vec3<double> support(const Vec3<double>& m) const;
  /// Returns a point of the hull that is nearly farthest in the direction m: support(m) without a search.
  Vec3<double> rough_support(const Vec3<double>& m) const;
  /// Whether rough_support() is support().
  bool rough_is_exact() const { return map_ != Map::curved; }
  /// Returns support(m, piece). slope: its derivative by m, m; symmetric and positive semidefinite, with the
  /// radii of curvature as eigenvalues for |m| = 1.
  Vec3<double> support(const Vec3<double>& m, int piece, Mat3<double>& slope) const;
  /// Returns the outward unit normal of end face 0 or 1.
  Vec3<double> end_face_normal(int piece) const;
  /// Returns the material point at a position x (m).
  Material<double> label(const Vec3<double>& x) const { return part_->label(x, *values_); }
  /// Returns the extents along the axes of the body frame, m.
  Vec3<double> extents() const;

  /// Returns the end face (0 or 1) whose normal is nearly m and that is wider than 2 one_point (m), or -1.
  int parallel_end_face(const Vec3<double>& m, double one_point) const;
  /// Appends points of the rim of an end face that is nearly parallel to a plane with the normal m. The first
  /// point is the farthest in the direction m; if the face is level, this point is arbitrary and left out.
  /// The next n_rim points (at most kMaxRimPoints) have fixed directions relative to the unit vector `along`
  /// (normal to m), so that they do not turn with the part. Of points nearer to each other than one_point (m)
  /// the first one is kept.
  void add_rim(const Vec3<double>& m, const Vec3<double>& along, int piece, double one_point, int n_rim,
               std::vector<Vec3<double>>& points) const;
  /// Appends the points that may touch a plane with the normal m (unit vector): the farthest point of each
  /// piece in the direction m. For end_face, the result of parallel_end_face(), points of its rim are
  /// appended (add_rim()). If a piece has nearly flat regions, the points that are farthest after a small
  /// turn of m in four directions are appended, too. So a face is represented by its corners, an edge or a
  /// generator by its ends, and a curved surface by one point. If the chain is not affine and the convexity
  /// is unknown, all points that are farthest among the points near them are appended
  /// (CurvedHull::add_local_points()).
  void touching_points(const Vec3<double>& m, const Vec3<double>& along, int end_face,
                       const PointLimits& limits, int n_rim, std::vector<Vec3<double>>& points) const;

 private:
  void add_face(const Vec3<double>& m, int piece, double one_point, std::vector<Vec3<double>>& points) const;

  const Part* part_;
  const ParameterValues<double>* values_;
  const ShapeInterface* shape_;
  ShapeParameters a_;
  double size_;
  Convexity convexity_;
  enum class Map { identity, affine, curved } map_;
  Mat3<double> F_;                    // matrix of an affine map
  std::optional<CurvedHull> curved_;  // of a curved map
};

}  // namespace pliant
