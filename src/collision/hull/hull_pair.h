// Separation and contact points of two convex parts, from their support functions. With the normal n from b
// to a (unit vector, world), the separation along n is
//   s(n) = min over x in a of n . x  -  max over y in b of n . y.
// The largest value of s over all n is the gap. The gradient of s is x - y, with the points x and y that
// attain the minimum and the maximum. If the parts overlap deeply, s has several local maxima. The search
// then starts from several normals and returns the best result.
#pragma once

#include <vector>

#include "hull.h"

namespace pliant {

/// A hull and its pose in the world.
struct PlacedHull {
  const Hull& hull;
  Vec3<double> c;    ///< origin of the body frame, m
  Mat3<double> R;    ///< body frame to world
  double thickness;  ///< least extent, m
  Vec3<double> into_body(const Vec3<double>& direction) const { return R.transpose() * direction; }
  Vec3<double> to_world(const Vec3<double>& p) const { return c + R * p; }
};

/// The largest separation of two parts, and its normal.
struct Separation {
  Vec3<double> normal;  ///< n, unit vector from b to a, world
  double gap = 0;       ///< s(n), m; negative: depth of the overlap
};

/// Returns the largest separation that is found. If s exceeds max_gap (m) along a normal of the search,
/// returns that normal at once.
Separation separation(const PlacedHull& a, const PlacedHull& b, double max_gap);

/// A point where two parts touch.
struct PairTouch {
  Vec3<double> x;  ///< on the surface of a, or of b (on_b of touch_pair()), m, world
  double gap;      ///< m
};

/// Appends the contact points of two parts: one point where curved surfaces touch, the two ends of a common
/// segment, or the corners of the common polygon of two faces. separation: the result of separation(). Points
/// with a gap above max_gap (m) are left out. on_b: whether the points are on the surface of b instead of a.
void touch_pair(const PlacedHull& a, const PlacedHull& b, const Separation& separation, double max_gap,
                bool on_b, std::vector<PairTouch>& found);

}  // namespace pliant
