// Contacts of a box with a box and with a ball, in closed form. Two boxes are tested along the face normals
// of both boxes and along the cross product of each pair of their edges (separating axes: Gottschalk, Lin and
// Manocha 1996). If the gap is largest along a face normal, the opposite face of the other box is clipped to
// that face, and the corners of the clipped face are the contact points. If the gap is largest along a cross
// product, the two edges cross, and the contact is one point.
#pragma once

#include <array>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

/// A box and its pose.
struct PlacedBox {
  Vec3<double> c;     ///< centre, m, world
  Mat3<double> R;     ///< box frame to world
  Vec3<double> half;  ///< half sizes, m
};

/// A contact of side a, a box or a ball, with side b, a box.
struct BoxTouch {
  Vec3<double> x;       ///< point on the surface of a, m, world
  Vec3<double> normal;  ///< unit vector from b to a, world
  double gap;           ///< distance along the normal, m; negative where the sides overlap
};

/// Returns the eight corners of a box with these half sizes, in its own frame.
std::array<Vec3<double>, 8> box_corners(const Vec3<double>& half);

/// Appends the contacts of boxes a and b whose gap is at most max_gap (m): one point for two crossing edges,
/// up to eight points for a face, or the nearest corner if the faces do not overlap. Each gap is measured
/// along the axis with the largest gap. For separated boxes this gap may be less than their distance.
void touch_boxes(const PlacedBox& a, const PlacedBox& b, double max_gap, std::vector<BoxTouch>& found);

/// Returns the contact of a ball (centre and radius in m, world) and a box. The ball is side a. BoxTouch::x
/// is the point of the ball that is nearest to the box, or deepest inside the box.
BoxTouch touch_ball(const Vec3<double>& centre, double radius, const PlacedBox& box);

}  // namespace pliant
