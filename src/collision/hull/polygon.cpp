#include "polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace pliant {

Point2 nearest_on_segment(const Point2& from, const Point2& to, const Point2& p) {
  const Point2 along = to - from;
  const double square = along.squaredNorm();
  return from + (square > 0 ? std::clamp(along.dot(p - from) / square, 0.0, 1.0) : 0.0) * along;
}

std::vector<std::size_t> convex_hull(const std::vector<Point2>& points) {
  std::vector<std::size_t> order(points.size()), around;
  std::iota(order.begin(), order.end(), std::size_t{0});
  if (points.size() < 3) return order;
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    const Point2 &a = points[i], &b = points[j];
    if (a.x() != b.x()) return a.x() < b.x();
    return a.y() < b.y() || (a.y() == b.y() && i < j);
  });
  auto add_side = [&](auto begin, auto end) {
    const std::size_t start = around.size();
    for (auto p = begin; p != end; ++p) {
      while (around.size() >= start + 2) {
        const Point2& before = points[around.end()[-2]];
        if (cross(points[around.back()] - before, points[*p] - before) > 0) break;
        around.pop_back();
      }
      around.push_back(*p);
    }
    around.pop_back();  // first point of the other side
  };
  add_side(order.begin(), order.end());
  add_side(order.rbegin(), order.rend());
  return around;
}

std::vector<Point2> clip(const std::vector<Point2>& corners, const Point2& p, const Point2& q) {
  std::vector<Point2> kept;
  auto side = [&](const Point2& x) { return cross(q - p, x - p); };
  const std::size_t n = corners.size();
  for (std::size_t k = 0; k < n; ++k) {
    const Point2 &from = corners[k], &to = corners[(k + 1) % n];
    const double s = side(from), s_to = side(to);
    if (s >= 0) kept.push_back(from);
    if (n == 2 && k == 1) break;
    if ((s < 0) != (s_to < 0)) kept.push_back(from + s / (s - s_to) * (to - from));
  }
  return kept;
}

std::vector<Point2> common_of_segments(const std::vector<Point2>& one, const std::vector<Point2>& other,
                                       double same) {
  const Point2 d = one[1] - one[0], along = other[1] - other[0];
  const double turn = cross(along, d);
  if (std::abs(turn) > same * std::max(along.norm(), d.norm())) {
    const double share = cross(along, Point2(other[0] - one[0])) / turn;
    return {one[0] + std::clamp(share, 0.0, 1.0) * d};
  }
  const Point2 across(-along.y(), along.x());
  const std::vector<Point2> kept = clip(one, other[0], other[0] - across);
  return kept.empty() ? kept : clip(kept, other[1], other[1] + across);
}

Point2 nearest_point(const std::vector<Point2>& own, const std::vector<Point2>& other, double same) {
  auto on_edge = [](const std::vector<Point2>& corners, std::size_t k, const Point2& p) {
    return nearest_on_segment(corners[k], corners[(k + 1) % corners.size()], p);
  };
  double least = std::numeric_limits<double>::infinity();
  Point2 sum(0, 0);
  int count = 0;
  auto consider = [&](const Point2& point, const Point2& opposite) {
    const double distance = (point - opposite).norm();
    if (distance > least + same) return;
    if (distance < least - same) {
      sum.setZero();
      count = 0;
    }
    least = std::min(least, distance);
    sum += point;
    ++count;
  };
  for (std::size_t i = 0; i < own.size(); ++i)
    for (std::size_t j = 0; j < other.size(); ++j) {
      consider(own[i], on_edge(other, j, own[i]));
      consider(on_edge(own, i, other[j]), other[j]);
    }
  return sum / count;
}

Point2 nearest_in(const std::vector<Point2>& corners, const Point2& p) {
  bool inside = corners.size() > 2;
  for (std::size_t k = 0; k < corners.size() && inside; ++k)
    inside = cross(corners[(k + 1) % corners.size()] - corners[k], p - corners[k]) >= 0;
  return inside ? p : nearest_point(corners, {p}, 0);
}

void merge(std::vector<Point2>& points, double same) {
  std::size_t n = 0;
  for (const Point2& p : points)
    if (std::none_of(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(n),
                     [&](const Point2& other) { return (p - other).norm() < same; }))
      points[n++] = p;
  points.resize(n);
}

}  // namespace pliant
