// Support points of deformed solids. The image of a convex piece under a chain of deformations T that is not
// affine has no support function in closed form. Let x = T(e) be a point of the image, F = dT/de and
// g = F^T m. x can be farthest in the direction m only if g has the direction of the outward normal nu of the
// undeformed piece at e (Barr 1984). So nu is the unknown: e = e(nu) is the support point of the piece
// (shape/shape.h), and Newton's method solves g x nu = 0.
#pragma once

#include <optional>

#include <pliant/part/part.h>

namespace pliant {

/// A family of convex pieces: (1 - share) times the piece `one` plus share times the piece `other`, with a
/// share from 0 to 1. The sides of capsules, cylinders and cones and the edges of boxes are such families.
struct PieceFamily {
  int one, other;
};

/// A point of the surface of a deformed solid that is farthest in a direction m, at least near this point.
struct ImagePoint {
  Vec3<double> normal;                        ///< outward unit normal nu of the undeformed solid at the point
  double share = 0;                           ///< share of the member of the family
  Vec3<double> x;                             ///< body frame, m
  double slope_share = 0;                     ///< m . dx/dshare, m
  Mat3<double> slope = Mat3<double>::Zero();  ///< derivative of x by m for |m| = 1, m; only if required
};

class ImageSupport {
 public:
  /// part: a part whose shape has a support function. part and values must outlive this object.
  ImageSupport(const Part& part, const ParameterValues<double>& values) : part_(part), values_(values) {}

  /// Returns the point of the member `share` of a family that is farthest in the direction m (unit vector).
  /// start: a normal near that of the point. with_slope: whether to compute ImagePoint::slope.
  ImagePoint farthest(const Vec3<double>& m, const PieceFamily& family, double share,
                      const Vec3<double>& start, bool with_slope) const;
  /// Returns the point of all members of a family that is farthest in the direction m. Returns std::nullopt
  /// if it is a point of the first or the last member. start: a point near the result.
  std::optional<ImagePoint> between(const Vec3<double>& m, const PieceFamily& family,
                                    const ImagePoint& start) const;
  /// Returns a normal from which the search for the farthest point in the direction m can start. If T is
  /// affine, it is the normal at the farthest point.
  Vec3<double> start(const Vec3<double>& m) const;
  /// Whether the image of a piece is convex at the point with the undeformed normal nu, with some margin.
  bool is_convex_at(const Vec3<double>& nu, int piece) const;

 private:
  struct Local;
  Local evaluate(const Vec3<double>& m, const PieceFamily& family, double share,
                 const Vec3<double>& normal) const;
  Local ascend(const Vec3<double>& m, const PieceFamily& family, bool free_share, Local at) const;

  const Part& part_;
  const ParameterValues<double>& values_;
};

}  // namespace pliant
