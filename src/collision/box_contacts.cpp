#include <pliant/collision/box_contacts.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

namespace pliant {

namespace {

/// A face's normal is taken before another axis along which the gap is greater by no more than this, in
/// sizes.
constexpr double kFaceFirst = 1e-6;
/// Edges whose directions differ by less than this (sine) are parallel: they cross nowhere.
constexpr double kParallelEdges = 1e-6;
/// Corners nearer than this, in sizes, are one.
constexpr double kOneCorner = 1e-6;

/// The axis across which two boxes are farthest apart.
struct Axis {
  Vec3<double> n = Vec3<double>::Zero();  ///< from a to b
  double gap = -std::numeric_limits<double>::infinity();
  int of_a = -1, of_b = -1;  ///< of which it is the face's normal; both: across an edge of each
};

double extent(const PlacedBox& box, const Vec3<double>& n) {
  return box.half.dot((box.R.transpose() * n).cwiseAbs());
}

Axis widest_gap(const PlacedBox& a, const PlacedBox& b, double size) {
  const Vec3<double> d = b.c - a.c;
  Axis best;
  auto look = [&](const Vec3<double>& n, int of_a, int of_b) {
    const double along = n.dot(d), gap = std::abs(along) - extent(a, n) - extent(b, n);
    if (best.gap == -std::numeric_limits<double>::infinity() || gap > best.gap + kFaceFirst * size)
      best = {along < 0 ? Vec3<double>(-n) : n, gap, of_a, of_b};
  };
  for (int i = 0; i < 3; ++i) look(a.R.col(i), i, -1);
  for (int j = 0; j < 3; ++j) look(b.R.col(j), -1, j);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const Vec3<double> across = a.R.col(i).cross(b.R.col(j));
      if (across.norm() > kParallelEdges) look(across.normalized(), i, j);
    }
  return best;
}

/// The corner that is farthest in a direction, world; along: but for this axis, where it is in the middle.
Vec3<double> farthest(const PlacedBox& box, const Vec3<double>& n, int along = -1) {
  Vec3<double> p = box.R.transpose() * n;
  for (int k = 0; k < 3; ++k) p[k] = k == along ? 0 : std::copysign(box.half[k], p[k]);
  return box.c + box.R * p;
}

/// The point of a box that is nearest to a point of the world.
Vec3<double> within(const PlacedBox& box, const Vec3<double>& x) {
  const Vec3<double> in_box = box.R.transpose() * (x - box.c);
  return box.c + box.R * in_box.cwiseMin(box.half).cwiseMax(-box.half);
}

/// Where the edges along axis i of a and j of b that face each other cross, on a.
Vec3<double> crossing(const PlacedBox& a, const PlacedBox& b, const Axis& axis) {
  const Vec3<double> p = farthest(a, axis.n, axis.of_a), q = farthest(b, -axis.n, axis.of_b);
  const Vec3<double> e = a.R.col(axis.of_a), f = b.R.col(axis.of_b), d = q - p;
  const double ef = e.dot(f), s = (d.dot(e) - ef * d.dot(f)) / (1 - ef * ef), most = a.half[axis.of_a];
  return p + std::clamp(s, -most, most) * e;
}

/// A face, and what is left of it when it is cut by four planes: at most eight corners, and with rounding
/// never more than half as many again for each plane.
struct Polygon {
  std::array<Vec3<double>, 20> corners;
  std::size_t n = 0;

  void add(const Vec3<double>& p) { corners[n++] = p; }
};

/// A convex polygon, cut to where n . x <= most: it may have one corner more.
void cut(Polygon& polygon, const Vec3<double>& n, double most) {
  Polygon kept;
  for (std::size_t k = 0; k < polygon.n; ++k) {
    const Vec3<double>&p = polygon.corners[k], &q = polygon.corners[(k + 1) % polygon.n];
    const double at_p = n.dot(p) - most, at_q = n.dot(q) - most;
    if (at_p <= 0) kept.add(p);
    if ((at_p < 0 && at_q > 0) || (at_p > 0 && at_q < 0)) kept.add(p + at_p / (at_p - at_q) * (q - p));
  }
  polygon = kept;
}

/// The face of a box that looks most against a direction, cut to what lies over face number `number` of
/// another one, whose normal that is.
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
      cut(polygon, out, out.dot(other.c) + other.half[side]);
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

void touch_boxes(const PlacedBox& a, const PlacedBox& b, double most, std::vector<BoxTouch>& found) {
  const double size = std::min(a.half.maxCoeff(), b.half.maxCoeff());
  const Axis axis = widest_gap(a, b, size);
  if (axis.gap > most) return;
  if (axis.of_a >= 0 && axis.of_b >= 0) {
    found.push_back({crossing(a, b, axis), -axis.n, axis.gap});
    return;
  }
  const bool on_a = axis.of_a >= 0;
  const PlacedBox &on = on_a ? a : b, &lies = on_a ? b : a;
  const Vec3<double> up = on_a ? axis.n : Vec3<double>(-axis.n);  // of the face that it lies on
  const double face = up.dot(on.c) + on.half[on_a ? axis.of_a : axis.of_b];
  const std::size_t first = found.size();
  auto add = [&](const Vec3<double>& p) {
    const double gap = up.dot(p) - face;
    if (gap > most) return;
    const BoxTouch touch{on_a ? within(a, p - gap * up) : p, -axis.n, gap};
    for (std::size_t k = first; k < found.size(); ++k)
      if ((found[k].x - touch.x).norm() < kOneCorner * size) {
        if (gap < found[k].gap) found[k] = touch;
        return;
      }
    found.push_back(touch);
  };
  const Polygon polygon = facing(lies, on, on_a ? axis.of_a : axis.of_b, up);
  for (std::size_t k = 0; k < polygon.n; ++k) add(polygon.corners[k]);
  if (found.size() == first) add(farthest(lies, -up));
}

BoxTouch touch_ball(const Vec3<double>& centre, double radius, const PlacedBox& box) {
  const Vec3<double> in_box = box.R.transpose() * (centre - box.c),
                     way = in_box - in_box.cwiseMin(box.half).cwiseMax(-box.half);
  const double distance = way.norm();
  Vec3<double> normal = Vec3<double>::Zero();  // in the frame of the box
  double gap = distance - radius;
  if (distance > 0) {
    normal = way / distance;
  } else {  // out through the nearest face
    int axis = 0;
    const double depth = (box.half - in_box.cwiseAbs()).minCoeff(&axis);
    normal[axis] = std::copysign(1.0, in_box[axis]);
    gap = -depth - radius;
  }
  normal = (box.R * normal).eval();
  return {centre - radius * normal, normal, gap};
}

}  // namespace pliant
