// Where boxes touch boxes and balls, in closed form: of two boxes the axis along which they overlap least is
// one of their faces' normals or across an edge of each (Gottschalk, Lin and Manocha 1996); a face of one,
// cut to what lies over the face of the other, carries it at its corners.
#pragma once

#include <array>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

struct PlacedBox {
  Vec3<double> c;     ///< centre, m, world
  Mat3<double> R;     ///< to the world
  Vec3<double> half;  ///< half sizes, m
};

struct BoxTouch {
  Vec3<double> x;       ///< on a, m, world
  Vec3<double> normal;  ///< from b to a, world
  double gap;           ///< along the normal, m
};

/// Corners of a box of these half sizes in its own frame.
std::array<Vec3<double>, 8> box_corners(const Vec3<double>& half);

/// Adds where boxes a and b touch with a gap of at most `most` m: one point of edges that cross or of corners
/// beside each other, up to eight of a face. Boxes that are apart have the gap between planes that part them.
void touch_boxes(const PlacedBox& a, const PlacedBox& b, double most, std::vector<BoxTouch>& found);

/// The point of a ball with this centre and radius (m, world) that is nearest to a box, or deepest in it.
BoxTouch touch_ball(const Vec3<double>& centre, double radius, const PlacedBox& box);

}  // namespace pliant
