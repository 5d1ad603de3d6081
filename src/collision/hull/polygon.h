// Points and convex polygons of a plane.
#pragma once

#include <vector>

#include <Eigen/Core>

namespace pliant {

using Point2 = Eigen::Vector2d;

/// Returns the third component of the cross product; positive if b is to the left of a.
inline double cross(const Point2& a, const Point2& b) {
  return a.x() * b.y() - a.y() * b.x();
}

/// Returns the numbers of the corners of the convex hull, counter-clockwise, by Andrew's monotone chains
/// (1979). Of equal points at least one is kept. Because of rounding the hull may keep points on its straight
/// sides.
std::vector<std::size_t> convex_hull(const std::vector<Point2>& points);

/// Returns the part of a segment or convex polygon that is on the left of the directed line from p to q.
std::vector<Point2> clip(const std::vector<Point2>& corners, const Point2& p, const Point2& q);

/// Returns the common part of two segments. If they are parallel, to within `same` (m) over the length of the
/// shorter one, returns the ends of their overlap, or an empty list. Otherwise returns the point where their
/// lines cross, moved to the nearer end of `one` if it is outside of `one`.
std::vector<Point2> common_of_segments(const std::vector<Point2>& one, const std::vector<Point2>& other,
                                       double same);

/// Returns the point of the segment from `from` to `to` that is nearest to p.
Point2 nearest_on_segment(const Point2& from, const Point2& to, const Point2& p);

/// Returns the point of the segment or outline `own` that is nearest to the segment, outline or point
/// `other`. The two must not overlap. If several points are nearest, as on parallel edges, returns a mean of
/// them. same: distances that differ by less (m) are equal.
Point2 nearest_point(const std::vector<Point2>& own, const std::vector<Point2>& other, double same);

/// Returns the point of a segment or polygon that is nearest to p.
Point2 nearest_in(const std::vector<Point2>& corners, const Point2& p);

/// Removes points that are nearer than `same` (m) to an earlier point that is kept.
void merge(std::vector<Point2>& points, double same);

}  // namespace pliant
