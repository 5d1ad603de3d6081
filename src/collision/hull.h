// The convex hull of a part in its body frame, by the support function of its shape (shape/shape.h). The
// chain of the part must map affinely (shear): the support point of the image F x of a shape in the direction
// m is F times the support point of the shape in the direction F^T m.
#pragma once

#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// Most points that represent the rim of an end face.
inline constexpr int kMaxRimPoints = 8;

/// Returns the distance below which two points of a part are one contact, m. thickness: least extent of the
/// part, m.
double one_point_distance(double thickness);

class Hull {
 public:
  /// Returns whether the hull of a part is known: its shape has a support function, and its chain is affine.
  static bool exists(const Part& part);
  /// part: has a hull; it and values must outlive this object.
  Hull(const Part& part, const ParameterValues<double>& values);

  int pieces() const { return shape_->hull_pieces(); }
  /// Whether a single piece has nearly flat regions, other than end faces.
  bool has_flat_regions() const { return shape_->has_flat_regions(a_); }
  bool has_end_faces() const { return shape_->has_end_faces(); }
  /// The largest half extent of the part at rest, m.
  double size() const { return size_; }
  /// Whether the part is its hull.
  bool is_convex() const { return shape_->is_convex(a_); }
  /// Returns the point (m) of a piece that is farthest in the direction m.
  Vec3<double> support(const Vec3<double>& m, int piece) const;
  /// Returns the point (m) of the hull that is farthest in the direction m.
  Vec3<double> support(const Vec3<double>& m) const;
  /// Returns support(m, piece). slope: its derivative by m, m; symmetric and positive semidefinite, with the
  /// radii of curvature as eigenvalues for |m| = 1.
  Vec3<double> support(const Vec3<double>& m, int piece, Mat3<double>& slope) const;
  /// Returns the outward unit normal of end face 0 or 1.
  Vec3<double> end_face_normal(int piece) const;
  /// Returns the extents along the axes of the body frame, m.
  Vec3<double> extents() const;

  /// Returns the end face (0 or 1) whose normal is nearly m and that is wider than 2 one_point (m), or -1.
  int parallel_end_face(const Vec3<double>& m, double one_point) const;
  /// Appends points of the rim of an end face that is nearly parallel to a plane with the normal m: the
  /// farthest point in the direction m, unless the face is level and this is an arbitrary point of the rim;
  /// and n_rim points (at most kMaxRimPoints) that keep their places relative to the unit vector `along`,
  /// which is normal to m, and not to the part. Of points nearer to each other than one_point (m) the first
  /// one is kept.
  void add_rim(const Vec3<double>& m, const Vec3<double>& along, int piece, double one_point, int n_rim,
               std::vector<Vec3<double>>& points) const;
  /// Appends the points that may touch a plane with the normal m: the farthest point of each piece in the
  /// direction m; for end_face, the result of parallel_end_face(), its rim (add_rim); and if a piece has
  /// nearly flat regions, the points that are farthest if m turns by a small angle, in four directions. So a
  /// face is represented by its corners, an edge or a generator by its ends, and a curved surface by one
  /// point. m: unit vector.
  void touching_points(const Vec3<double>& m, const Vec3<double>& along, int end_face, double one_point,
                       int n_rim, std::vector<Vec3<double>>& points) const;

 private:
  void add_face(const Vec3<double>& m, int piece, double one_point, std::vector<Vec3<double>>& points) const;

  const ShapeInterface* shape_;
  ShapeParameters a_;
  double size_;
  bool is_undeformed_;
  Mat3<double> F_;
};

}  // namespace pliant
