// Parts whose chain of deformations is not affine (taper, twist, bend): support points, the test whether the
// part is convex, and the points that are farthest in a direction among the points near them.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "image_support.h"

namespace pliant {

/// Limits of the points that a search returns.
struct PointLimits {
  double one_point;  ///< of points nearer to each other than this (m) one is kept
  /// Points x with a smaller m . x (m) may be left out; m: direction of the search, unit vector.
  double least_height = -std::numeric_limits<double>::infinity();
};

/// Adds a point, unless m . p < limits.least_height. Of points nearer to each other than limits.one_point,
/// only the farthest in the direction m is kept.
void add_farthest(const Vec3<double>& m, const Vec3<double>& p, const PointLimits& limits,
                  std::vector<Vec3<double>>& points);

class CurvedHull {
 public:
  /// Whether this class can find the points of a part at these values. The shape must be convex, without
  /// nearly flat regions and exponents below 1. Its hull must have one piece, two pieces or the pieces of a
  /// box (shape/shape.h). Only affine links of the chain may follow a bend. The chain must not turn by more
  /// than about 1 rad per seventh of the length, nor by more than 3 rad in all if there is one piece.
  static bool exists(const Part& part, const ParameterValues<double>& values);
  /// part and values must outlive this object.
  CurvedHull(const Part& part, const ParameterValues<double>& values);

  /// Returns the point (m) of the image of a piece that is farthest in the direction m (unit vector), at
  /// least among the points near it. slope: if given, the derivative of this point by m, m.
  Vec3<double> support(const Vec3<double>& m, int piece, Mat3<double>* slope) const;
  /// Returns a point of the image of a piece that is nearly farthest in the direction m, without a search.
  /// If the chain were replaced by its linearisation at the origin, this material point would be farthest.
  Vec3<double> rough_support(const Vec3<double>& m, int piece) const;
  /// Returns the outward unit normal of end face 0 or 1.
  Vec3<double> end_face_normal(int piece) const;
  /// Whether the part is convex, tested at samples: a surface with one piece must be curved outwards, sides
  /// must be developable, and the faces of boxes must be plane. With dynamic parameters of the chain, parts
  /// with several pieces are treated as not convex, because they can be convex at single values only.
  bool is_convex() const;
  /// Appends the points of the surface that are farthest in the direction m among the points near them, and
  /// the corners of a box, or the ends of the farthest generator of a part with two pieces. end_face: the
  /// number of an end face whose points are left out, or -1.
  void add_local_points(const Vec3<double>& m, int end_face, const PointLimits& limits,
                        std::vector<Vec3<double>>& points) const;

 private:
  static constexpr int kMaxIntervals = 16;
  /// Farthest points of members of a family (PieceFamily) at equal steps of the share.
  using Stations = std::array<ImagePoint, static_cast<std::size_t>(kMaxIntervals) + 1>;

  /// The derivative of the chain at points of the z axis.
  struct Axis {
    static constexpr int kPlaces = 8;
    std::array<Mat3<double>, kPlaces> F;  ///< dT/de at equal distances, from the upper end to the lower one
    double turn, largest_turn;            ///< sum and maximum of the turns from place to place, rad
    int intervals() const;                ///< number of intervals into which generators and edges are divided
  };
  Axis axis() const;
  Vec3<double> undeformed(const Vec3<double>& m, int piece) const;
  Vec3<double> sample_normal(std::size_t k, const Vec3<double>& half_sizes) const;
  Vec3<double> half_sizes() const;
  bool has_developable_sides() const;
  bool has_plane_faces() const;
  bool is_straight(const Vec3<double>& from, const Vec3<double>& to) const;
  void add_hills(const Vec3<double>& m, const PointLimits& limits, std::vector<Vec3<double>>& points) const;
  void add_side(const Vec3<double>& m, int end_face, const PointLimits& limits,
                std::vector<Vec3<double>>& points) const;
  void add_edge(const Vec3<double>& m, const PieceFamily& edge, int n, const PointLimits& limits,
                std::vector<Vec3<double>>& points) const;
  void add_inner(const Vec3<double>& m, const PieceFamily& family, const Stations& stations, int n,
                 const PointLimits& limits, std::vector<Vec3<double>>& points) const;

  const Part& part_;
  const ParameterValues<double>& values_;
  const ShapeInterface& shape_;
  ImageSupport image_;
  /// The last support point of a piece and its direction; the search for the next one starts from it.
  struct LastPoint {
    Vec3<double> m = Vec3<double>::Zero();
    ImagePoint point;
  };
  mutable std::array<LastPoint, static_cast<std::size_t>(kMaxHullPieces)> last_points_;
};

}  // namespace pliant
