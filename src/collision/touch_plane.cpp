#include "touch_plane.h"

namespace pliant {

namespace {
/// Points of a part that are nearer to each other than this, in half thicknesses, are one point.
constexpr double kOnePoint = 0.1;
/// Number of points that represent a round end face.
constexpr int kRimPoints = 4;
}  // namespace

double one_point_distance(double thickness) {
  return kOnePoint * 0.5 * thickness;
}

void touch_plane(const Part& part, const ParameterValues<double>& values, double thickness,
                 const PlaneInBody& plane, double max_gap, std::vector<Vec3<double>>& points,
                 std::vector<CollisionSurface::LowPoint>& found) {
  const Hull hull(part, values);
  points.clear();
  hull.touching_points(-plane.normal, plane.along, one_point_distance(thickness), kRimPoints, points);
  for (const Vec3<double>& p : points)
    if (const double height = plane.normal.dot(p) + plane.offset; height <= max_gap)
      found.push_back({part.label(p, values), p, height});
}

}  // namespace pliant
