// Contact points of two convex parts for a known normal: the points of each part that are nearest to the
// other part form a point, a segment or a polygon; their common part, in the projection along the normal, is
// the contact.
#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "hull_pair.h"
#include "polygon.h"

namespace pliant {

namespace {

/// Points belong to a face if they are at most this far behind its nearest point, in units of
/// one_point_distance(). All points of an end face belong to the face, at any distance.
constexpr double kFaceDepth = 0.2;

/// A face of one part: the corners of the convex hull of its points in the projection along the normal,
/// counter-clockwise, and its height n . x as a linear function of the place.
struct Face {
  std::vector<Point2> corners;
  Vec3<double> height = Vec3<double>::Zero();  ///< (h_0, slopes): h = h_0 + slopes . place
  /// Whether the part has one nearest point: the face has one corner, or the part has nearly flat regions, on
  /// which exactly one point is nearest.
  bool is_point = false;

  double height_at(const Point2& p) const { return height[0] + height.tail<2>().dot(p); }
};

/// Returns the face of a part that is nearest to the other part. n: the normal. E: two unit vectors
/// perpendicular to n, the axes of the projection. origin: origin of the projection, m, world. side: -1 for
/// part a, 1 for part b.
Face face_of(const PlacedHull& part, const Vec3<double>& n, const Eigen::Matrix<double, 3, 2>& E,
             const Vec3<double>& origin, double side) {
  const double same = one_point_distance(part.thickness);
  std::vector<Vec3<double>> points;
  const Vec3<double> m = part.into_body(side * n), axis = part.into_body(E.col(0));
  if (const int end_face = part.hull.parallel_end_face(m, same); end_face >= 0) {
    part.hull.add_rim(m, axis, end_face, same, kMaxRimPoints, points);
  } else {
    part.hull.touching_points(m, axis, end_face, {same}, kMaxRimPoints, points);
    double farthest = m.dot(points[0]);
    for (const Vec3<double>& p : points) farthest = std::max(farthest, m.dot(p));
    points.erase(
        std::remove_if(points.begin(), points.end(),
                       [&](const Vec3<double>& p) { return m.dot(p) < farthest - kFaceDepth * same; }),
        points.end());
  }
  Face face;
  std::vector<double> heights;
  for (const Vec3<double>& p : points) {
    const Vec3<double> x = part.to_world(p) - origin;
    face.corners.push_back(E.transpose() * x);
    heights.push_back(n.dot(x));
  }
  // The plane or line of heights by least squares.
  const auto n_points = static_cast<double>(heights.size());
  Point2 middle(0, 0), moment(0, 0), slopes(0, 0);
  double mean = 0;
  for (std::size_t k = 0; k < heights.size(); ++k) {
    middle += face.corners[k] / n_points;
    mean += heights[k] / n_points;
  }
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  for (std::size_t k = 0; k < heights.size(); ++k) {
    const Point2 from_middle = face.corners[k] - middle;
    spread += from_middle * from_middle.transpose();
    moment += from_middle * (heights[k] - mean);
  }
  if (spread.determinant() > same * same * spread.trace())
    slopes = spread.inverse() * moment;
  else if (spread.trace() > same * same)  // along a line: spread is L L^T, and moment is a multiple of L
    slopes = moment / spread.trace();
  face.height << mean - slopes.dot(middle), slopes;
  merge(face.corners, same);
  std::vector<Point2> outline;
  for (const std::size_t k : convex_hull(face.corners)) outline.push_back(face.corners[k]);
  face.corners = std::move(outline);
  face.is_point = face.corners.size() == 1 || part.hull.has_flat_regions();
  return face;
}

/// Returns the common part of two faces in the projection along the normal: corners of a polygon, ends of a
/// segment, or a crossing point of two segments. The list is empty if a face has one corner. It has
/// no crossing point if is_point is true for a face. same: points nearer to each other than this (m) are
/// merged.
std::vector<Point2> common_part(const Face& of_a, const Face& of_b, double same) {
  if (of_a.corners.size() == 1 || of_b.corners.size() == 1) return {};
  const bool clip_a = of_b.corners.size() > 2;
  std::vector<Point2> common = clip_a ? of_a.corners : of_b.corners;
  const std::vector<Point2>& by = clip_a ? of_b.corners : of_a.corners;
  if (by.size() == 2) {
    common = common_of_segments(common, by, same);
    if (common.size() == 1 && (of_a.is_point || of_b.is_point)) common.clear();
  }
  for (std::size_t k = 0; by.size() > 2 && k < by.size() && !common.empty(); ++k)
    common = clip(common, by[k], by[(k + 1) % by.size()]);
  merge(common, same);
  return common;
}

}  // namespace

void touch_pair(const PlacedHull& a, const PlacedHull& b, const Separation& separation, double max_gap,
                bool on_b, std::vector<PairTouch>& found) {
  const Vec3<double>& n = separation.normal;
  const Vec3<double> origin = 0.5 * (a.c + b.c);
  Eigen::Matrix<double, 3, 2> E;
  // E depends on a fixed direction of the world, so that the points of a rim keep their places from step to
  // step.
  const Vec3<double> fixed = std::abs(n[0]) < 0.9 ? Vec3<double>::UnitX() : Vec3<double>::UnitY();
  E.col(0) = (fixed - n.dot(fixed) * n).normalized();
  E.col(1) = n.cross(E.col(0));
  const Face of_a = face_of(a, n, E, origin, -1), of_b = face_of(b, n, E, origin, 1);
  const double same = one_point_distance(std::min(a.thickness, b.thickness));
  double deepest = std::numeric_limits<double>::infinity();
  const std::size_t first = found.size();
  const std::vector<Point2> common = common_part(of_a, of_b, same);
  for (const Point2& p : common) {
    // No gap is less than s(n). The plane through a face may give less, because a face is not exactly flat.
    const double h_a = of_a.height_at(p), h_b = of_b.height_at(p), gap = std::max(h_a - h_b, separation.gap);
    if (gap > max_gap) continue;
    deepest = std::min(deepest, gap);
    found.push_back({origin + E * p + (on_b ? h_b : h_a) * n, gap});
  }
  // Where no face touches a face, the contact is the point that attains s(n) (hull_pair.h). This point is
  // also added if it is deeper than the common corners, because a surface is not exactly flat.
  const double rounding = 1e-12 * (a.hull.size() + b.hull.size());
  if (separation.gap > max_gap || (found.size() > first && !(separation.gap < deepest - rounding))) return;
  const Face &own = on_b ? of_b : of_a, &other = on_b ? of_a : of_b;
  const PlacedHull &own_part = on_b ? b : a, &other_part = on_b ? a : b;
  const double side = on_b ? 1 : -1;
  auto support = [&](const PlacedHull& part, double sign) {
    return part.to_world(part.hull.support(part.into_body(sign * n)));
  };
  // A point in a nearly flat region depends strongly on n, so a point of a curved part is preferred.
  auto rank = [](const Face& face, const PlacedHull& part) {
    return !face.is_point ? 0 : part.hull.has_flat_regions() ? 1 : 2;
  };
  const int of_own = rank(own, own_part), of_other = rank(other, other_part);
  Vec3<double> x;
  if (of_own > 0 && of_own >= of_other) {
    x = support(own_part, side);
  } else if (of_other > 0) {
    x = support(other_part, -side) - side * separation.gap * n;
  } else if (!common.empty()) {
    x = support(own_part, side);
  } else {  // the polygons do not overlap, although the rims that they represent do
    const Point2 p = nearest_point(own.corners, other.corners, rounding);
    x = origin + E * p + own.height_at(p) * n;
  }
  // The point of a nearly flat region is moved into the face of the other part.
  const Face& face = of_own >= of_other ? other : own;
  if (std::max(of_own, of_other) == 1 && face.corners.size() > 1)
    x += E * (nearest_in(face.corners, E.transpose() * (x - origin)) - E.transpose() * (x - origin));
  found.push_back({x, separation.gap});
}

}  // namespace pliant
