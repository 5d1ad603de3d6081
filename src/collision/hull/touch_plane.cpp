#include "touch_plane.h"

namespace pliant {

namespace {
/// Number of points on the rim of a round end face, besides its lowest point.
constexpr int kRimPoints = 4;
}  // namespace

void touch_plane(const Hull& hull, double thickness, const PlaneInBody& plane, double max_gap,
                 std::vector<Vec3<double>>& points, std::vector<PlaneTouch>& found) {
  points.clear();
  found.clear();
  const Vec3<double> down = -plane.normal;
  const double one_point = one_point_distance(thickness);
  const PointLimits limits{one_point, plane.offset - max_gap - one_point};
  hull.touching_points(down, plane.along, hull.parallel_end_face(down, one_point), limits, kRimPoints,
                       points);
  for (const Vec3<double>& p : points)
    if (const double height = plane.normal.dot(p) + plane.offset; height <= max_gap)
      found.push_back({p, height});
}

}  // namespace pliant
