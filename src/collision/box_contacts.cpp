// Separating axis test of two boxes, clipping of a face to the opposite face, and the point of a ball that is
// nearest to a box.
#include <pliant/collision/box_contacts.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace pliant {

namespace {

/// An axis replaces the best axis so far only if its gap is larger by more than this, in sizes (largest half
/// size) of the smaller box. Face normals are tested first, and thus preferred.
constexpr double kFaceFirst = 1e-6;
/// Two edges are parallel, and have no crossing, if the sine of the angle between them is below this.
constexpr double kParallelEdges = 1e-6;
/// Corners nearer than this, in sizes of the smaller box, are merged.
constexpr double kSameCorner = 1e-6;

/// The axis along which the gap between two boxes is largest.
struct Axis {
  Vec3<double> n = Vec3<double>::Zero();  ///< unit vector from a to b, world
  double gap = -std::numeric_limits<double>::infinity();
  /// Numbers of an axis of box a and of box b. If of_b is -1, n is along the axis of a. If of_a is -1, n is
  /// along the axis of b. Otherwise n is along the cross product of both axes.
  int of_a = -1, of_b = -1;
};

/// Half the extent of a box along a unit vector, m.
double extent(const PlacedBox& box, const Vec3<double>& n) {
  return box.half.dot((box.R.transpose() * n).cwiseAbs());
}

Axis widest_gap(const PlacedBox& a, const PlacedBox& b, double size) {
  const Vec3<double> d = b.c - a.c;
  Axis best;
  auto test = [&](const Vec3<double>& n, int of_a, int of_b) {
    const double along = n.dot(d), gap = std::abs(along) - extent(a, n) - extent(b, n);
    if (best.gap == -std::numeric_limits<double>::infinity() || gap > best.gap + kFaceFirst * size)
      best = {along < 0 ? Vec3<double>(-n) : n, gap, of_a, of_b};
  };
  for (int i = 0; i < 3; ++i) test(a.R.col(i), i, -1);
  for (int j = 0; j < 3; ++j) test(b.R.col(j), -1, j);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3<double> across = a.R.col(i).cross(b.R.col(j));
      if (across.norm() > kParallelEdges) test(across.normalized(), i, j);
    }
  return best;
}

/// Returns the corner of a box that is farthest in the direction n, m, world. along: if given, an axis of the
/// box; the middle of the farthest edge along this axis is returned instead.
Vec3<double> farthest_corner(const PlacedBox& box, const Vec3<double>& n, int along = -1) {
  Vec3<double> p = box.R.transpose() * n;
  for (int k = 0; k < 3; ++k) p[k] = k == along ? 0 : std::copysign(box.half[k], p[k]);
  return box.c + box.R * p;
}

/// Returns the point of a box that is nearest to a point of the world.
Vec3<double> nearest_in_box(const PlacedBox& box, const Vec3<double>& x) {
  const Vec3<double> in_box = box.R.transpose() * (x - box.c);
  return box.c + box.R * in_box.cwiseMin(box.half).cwiseMax(-box.half);
}

/// Returns the point of an edge of a that is nearest to an edge of b. The cross product of the two edges is
/// along `axis`. Of the edges with these directions, the two that face each other are used.
Vec3<double> crossing(const PlacedBox& a, const PlacedBox& b, const Axis& axis) {
  const Vec3<double> p = farthest_corner(a, axis.n, axis.of_a), q = farthest_corner(b, -axis.n, axis.of_b);
  const Vec3<double> e = a.R.col(axis.of_a), f = b.R.col(axis.of_b), d = q - p;
  const double ef = e.dot(f), s = (d.dot(e) - ef * d.dot(f)) / (1 - ef * ef), half = a.half[axis.of_a];
  return p + std::clamp(s, -half, half) * e;
}

/// A face of a box that is clipped by four planes. In exact arithmetic it has at most eight corners. With
/// rounding, each plane makes the number of corners at most 1.5 times as large (4, 6, 9, 13, 19), so 20
/// entries suffice.
struct Polygon {
  std::array<Vec3<double>, 20> corners;
  std::size_t n = 0;

  void add(const Vec3<double>& p) { corners[n++] = p; }
};

/// Clips a convex polygon to the half space n . x <= bound.
void clip(Polygon& polygon, const Vec3<double>& n, double bound) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.n; ++k) {
    const Vec3<double>&p = polygon.corners[k], &q = polygon.corners[(k + 1) % polygon.n];
    const double at_p = n.dot(p) - bound, at_q = n.dot(q) - bound;
    if (at_p <= 0) kept.add(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) kept.add(p + at_p / (at_p - at_q) * (q - p));
  }
  polygon = kept;
}

/// Returns the face of a box whose normal is most opposite to n, clipped to the region over a face of the
/// other box. The face of the other box has the normal n, along axis `number` of that box.
Polygon facing(const PlacedBox& box, const PlacedBox& other, int number, const Vec3<double>& n) {
  const Vec3<double> in_box = box.R.transpose() * n;
  int k = 0;
  in_box.cwiseAbs().maxCoeff(&k);
  const Vec3<double> u = box.half[(k + 1) % 3] * box.R.col((k + 1) % 3),
                     v = box.half[(k + 2) % 3] * box.R.col((k + 2) % 3),
                     middle = box.c - std::copysign(box.half[k], in_box[k]) * box.R.col(k);
  Polygon polygon{{middle + u + v, middle - u + v, middle - u - v, middle + u - v}, 4};
  for (const int side : {(number + 1) % 3, (number + 2) % 3})
    for (const double sign : {-1.0, 1.0}) {
      const Vec3<double> out = sign * other.R.col(side);
      clip(polygon, out, out.dot(other.c) + other.half[side]);
    }
  return polygon;
}

}  // namespace

std::array<Vec3<double>, 8> box_corners(const Vec3<double>& half) {
  std::array<Vec3<double>, 8> corners;
  for (std::size_t k = 0; k < 8; ++k)
    corners[k] = half.cwiseProduct(Vec3<double>(k & 1 ? 1 : -1, k & 2 ? 1 : -1, k & 4 ? 1 : -1));
  return corners;
}

void touch_boxes(const PlacedBox& a, const PlacedBox& b, double max_gap, std::vector<BoxTouch>& found) {
  const double size = std::min(a.half.maxCoeff(), b.half.maxCoeff());
  const Axis axis = widest_gap(a, b, size);
  if (axis.gap > max_gap) return;
  if (axis.of_a >= 0 && axis.of_b >= 0) {
    found.push_back({crossing(a, b, axis), -axis.n, axis.gap});
    return;
  }
  const bool on_a = axis.of_a >= 0;
  const PlacedBox &support = on_a ? a : b, &resting = on_a ? b : a;
  const Vec3<double> up = on_a ? axis.n : Vec3<double>(-axis.n);  // normal of the supporting face
  const double face = up.dot(support.c) + support.half[on_a ? axis.of_a : axis.of_b];
  const std::size_t first = found.size();
  auto add = [&](const Vec3<double>& p) {
    const double gap = up.dot(p) - face;
    if (gap > max_gap) return;
    const BoxTouch touch{on_a ? nearest_in_box(a, p - gap * up) : p, -axis.n, gap};
    for (std::size_t k = first; k < found.size(); ++k)
      if ((found[k].x - touch.x).norm() < kSameCorner * size) {
        if (gap < found[k].gap) found[k] = touch;
        return;
      }
    found.push_back(touch);
  };
  const Polygon polygon = facing(resting, support, on_a ? axis.of_a : axis.of_b, up);
  for (std::size_t k = 0; k < polygon.n; ++k) add(polygon.corners[k]);
  if (found.size() == first) add(farthest_corner(resting, -up));
}

BoxTouch touch_ball(const Vec3<double>& centre, double radius, const PlacedBox& box) {
  const Vec3<double> in_box = box.R.transpose() * (centre - box.c),
                     outward = in_box - in_box.cwiseMin(box.half).cwiseMax(-box.half);
  const double distance = outward.norm();
  Vec3<double> normal = Vec3<double>::Zero();  // in the frame of the box
  double gap = distance - radius;
  if (distance > 0) {
    normal = outward / distance;
  } else {  // the centre is inside the box: the nearest face gives the normal
    int axis = 0;
    const double depth = (box.half - in_box.cwiseAbs()).minCoeff(&axis);
    normal[axis] = std::copysign(1.0, in_box[axis]);
    gap = -depth - radius;
  }
  normal = (box.R * normal).eval();
  return {centre - radius * normal, normal, gap};
}

}  // namespace pliant
