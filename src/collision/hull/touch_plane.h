// Contact points of a part and a plane, from the support function of the part. Only the convex hull of a part
// can touch a plane, so the points are exact also for a part that is not convex, such as a torus.
#pragma once

#include <vector>

#include "hull.h"

namespace pliant {

/// A plane in the frame of a part.
struct PlaneInBody {
  Vec3<double> normal;  ///< unit vector, out of the solid half space below the plane
  double offset;        ///< height of the origin of the frame over the plane, m
  Vec3<double> along;   ///< unit vector in the plane; it is fixed to the plane, not to the part
};

/// A point where a part touches a plane.
struct PlaneTouch {
  Vec3<double> p;  ///< body frame, m
  double height;   ///< over the plane, m
};

/// Finds the points of a part that touch a plane (Hull::touching_points) and are at most max_gap (m) above
/// it; `found` is overwritten. thickness: least extent of the part, m. points: scratch storage.
void touch_plane(const Hull& hull, double thickness, const PlaneInBody& plane, double max_gap,
                 std::vector<Vec3<double>>& points, std::vector<PlaneTouch>& found);

}  // namespace pliant
