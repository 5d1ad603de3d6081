// The convex hull of a part in its body frame, by the support function of its shape (shape/shape.h). If the
// chain of the part maps affinely (shear), the support point of the image F x of a shape in the direction m
// is F times the support point of the shape in the direction F^T m. The support points of other chains are
// found by Newton's method (curved_hull.h).
#pragma once

#include <vector>

#include "curved_hull.h"

namespace pliant {

/// Most points that represent the rim of an end face.
inline constexpr int kMaxRimPoints = 8;

/// Returns the distance below which two points of a part are one contact, m. thickness: least extent of the
/// part, m.
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
  /// convex: the part is convex, or is treated as if it were. unknown: the part may be not convex.
  enum class Convexity { convex, unknown };
  /// part: its hull exists; it and values must outlive this object. If the convexity is unknown and the chain
  /// is not affine, touching_points() searches from several starts.
  Hull(const Part& part, const ParameterValues<double>& values, Convexity convexity);

  int pieces() const { return shape_->hull_pieces(); }
  /// Whether a single piece has nearly flat regions, other than end faces.
  bool has_flat_regions() const { return shape_->has_flat_regions(a_); }
  bool has_end_faces() const { return shape_->has_end_faces(); }
  /// The largest half extent of the part at rest, m.
  double size() const { return size_; }
  /// Returns the point (m) of a piece that is farthest in the direction m.
  Vec3<double> support(const Vec3<double>& m, int piece) const;
  /// Returns the point (m) of the hull that is farthest in the direction m.
  Vec3<double> support(const Vec3<double>& m) const;
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
  /// one is the farthest point in the direction m, unless the face is level and this is an arbitrary point of
  /// the rim. The others are n_rim points (at most kMaxRimPoints) that keep their places relative to the unit
  /// vector `along` (normal to m), not relative to the part. Of points nearer to each other than one_point
  /// (m) the first one is kept.
  void add_rim(const Vec3<double>& m, const Vec3<double>& along, int piece, double one_point, int n_rim,
               std::vector<Vec3<double>>& points) const;
  /// Appends the points that may touch a plane with the normal m: the farthest point of each piece in the
  /// direction m; for end_face, the result of parallel_end_face(), its rim (add_rim); and if a piece has
  /// nearly flat regions, the points that are farthest if m turns by a small angle, in four directions. So a
  /// face is represented by its corners, an edge or a generator by its ends, and a curved surface by one
  /// point. If the part is not convex, these are the points that are farthest among the points near them, and
  /// a generator or edge that is curved has such points between its ends, too. m: unit vector.
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
  Mat3<double> F_;  // of an affine map
  CurvedHull curved_;
};

}  // namespace pliant
