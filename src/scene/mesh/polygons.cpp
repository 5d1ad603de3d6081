#include "polygons.h"

#include <algorithm>
#include <stdexcept>

#include <Eigen/Geometry>

namespace pliant {

namespace {

constexpr int kMaxConcave = 1000;

/// The corners of one polygon and its normal (Newell's method).
struct Polygon {
  const std::vector<Vec3<double>>& x;
  const int* corners;
  int n;
  Vec3<double> normal = Vec3<double>::Zero();

  Polygon(const std::vector<Vec3<double>>& vertices, const int* first, int size)
      : x(vertices), corners(first), n(size) {
    for (int k = 1; k + 1 < n; ++k) normal += (at(k) - at(0)).cross(at(k + 1) - at(0));
  }
  const Vec3<double>& at(int k) const { return x[static_cast<std::size_t>(corners[k])]; }
  /// Returns twice the area of a triangle of corners times |normal|. The sign is positive if the triangle has
  /// the orientation of the polygon.
  double turn(int a, int b, int c) const { return (at(b) - at(a)).cross(at(c) - at(b)).dot(normal); }
  bool convex() const {
    for (int k = 0; k < n; ++k)
      if (turn(k, (k + 1) % n, (k + 2) % n) < 0) return false;
    return true;
  }
  bool contains(int a, int b, int c, int p) const {
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
  }
};

void add_triangle(const Polygon& polygon, int a, int b, int c, RawMesh& mesh) {
  mesh.triangles.push_back({polygon.corners[a], polygon.corners[b], polygon.corners[c]});
}

/// Returns the position in `left` of a corner whose triangle with its neighbours is an ear. If there is no
/// such corner (the polygon crosses itself), returns 0.
std::size_t find_ear(const Polygon& polygon, const std::vector<int>& left) {
  const std::size_t n = left.size();
  for (std::size_t i = 0; i < n; ++i) {
    const int a = left[(i + n - 1) % n], b = left[i], c = left[(i + 1) % n];
    if (polygon.turn(a, b, c) <= 0) continue;
    const bool empty = std::none_of(left.begin(), left.end(), [&](int p) {
      return polygon.at(p) != polygon.at(a) && polygon.at(p) != polygon.at(b) &&
             polygon.at(p) != polygon.at(c) && polygon.contains(a, b, c, p);
    });
    if (empty) return i;
  }
  return 0;
}

void cut_ears(const Polygon& polygon, RawMesh& mesh) {
  std::vector<int> left(static_cast<std::size_t>(polygon.n));
  for (std::size_t k = 0; k < left.size(); ++k) left[k] = static_cast<int>(k);
  while (left.size() > 3) {
    const std::size_t ear = find_ear(polygon, left), n = left.size();
    add_triangle(polygon, left[(ear + n - 1) % n], left[ear], left[(ear + 1) % n], mesh);
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(ear));
  }
  add_triangle(polygon, left[0], left[1], left[2], mesh);
}

}  // namespace

void add_polygons(const Polygons& polygons, const std::string& name, RawMesh& mesh) {
  const int* first = polygons.corners.data();
  for (std::size_t face = 0; face < polygons.sizes.size(); ++face) {
    const Polygon polygon(mesh.vertices, first, polygons.sizes[face]);
    first += polygon.n;
    if (mesh.triangles.size() + static_cast<std::size_t>(polygon.n) > kMaxTriangles)
      throw std::invalid_argument(name + ": more than " + std::to_string(kMaxTriangles) + " triangles");
    if (polygon.n == 3 || polygon.convex()) {
      for (int k = 1; k + 1 < polygon.n; ++k) add_triangle(polygon, 0, k, k + 1, mesh);
      continue;
    }
    if (polygon.n > kMaxConcave)
      throw std::invalid_argument(name + ": face " + std::to_string(face) + " is not convex and has " +
                                  std::to_string(polygon.n) + " corners; expected at most " +
                                  std::to_string(kMaxConcave) + ", or convex faces");
    cut_ears(polygon, mesh);
  }
}

}  // namespace pliant
