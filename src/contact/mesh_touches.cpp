#include <pliant/contact/mesh_touches.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

namespace pliant {

namespace {

/// Edges go across each other by less than this share of the shorter one; deeper, vertices are inside.
constexpr double kEdgeDepth = 0.5;
/// Edges whose sine of the angle between them is below this are parallel.
constexpr double kParallel = 1e-9;
/// Distances to triangles that differ by less than this part are to a common edge or corner of theirs.
constexpr double kTie = 1e-9;
/// A triangle is straight above a point whose distance to it squared is that to its plane, but for this.
constexpr double kStraight = 1e-6;
/// Edges whose triangles turn by less than this, rad, do not stick out.
constexpr double kFlat = 1e-6;
/// Triangles of an obstacle are searched to this share of the greatest depth around a part.
constexpr double kMargin = 0.1;
/// Sine of an angle by which a normal at a corner of an obstacle may point into it.
constexpr double kOut = 1e-3;
/// Two triangles of a ridge whose normals have a cosine below this are the sides of a plate.
constexpr double kBackToBack = -0.999999;

/// The point of a triangle that is nearest to x: its weights.
Vec3<double> nearest_weights(const Vec3<double>& x, const Vec3<double>& p0, const Vec3<double>& p1,
                             const Vec3<double>& p2) {
  const Vec3<double> e1 = p1 - p0, e2 = p2 - p0, d = x - p0;
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2), d1 = e1.dot(d), d2 = e2.dot(d);
  const double area = a * c - b * b, s = c * d1 - b * d2, t = a * d2 - b * d1;
  if (area > 0 && s >= 0 && t >= 0 && s + t <= area) return {1 - (s + t) / area, s / area, t / area};
  auto along = [](double dot, double length2) {
    return length2 > 0 ? std::clamp(dot / length2, 0.0, 1.0) : 0.0;
  };
  const double on_1 = along(d1, a), on_2 = along(d2, c),
               on_3 = along((x - p1).dot(p2 - p1), (p2 - p1).squaredNorm());
  const std::array<Vec3<double>, 3> border{Vec3<double>(1 - on_1, on_1, 0), Vec3<double>(1 - on_2, 0, on_2),
                                           Vec3<double>(0, 1 - on_3, on_3)};
  auto distance = [&](const Vec3<double>& w) {
    return (w[0] * p0 + w[1] * p1 + w[2] * p2 - x).squaredNorm();
  };
  return *std::min_element(border.begin(), border.end(), [&](const auto& one, const auto& other) {
    return distance(one) < distance(other);
  });
}

/// An edge that sticks out, and the normals to its left and right.
struct Ridge {
  int from, to;
  Vec3<double> left, right;
};

/// The part of a mesh that may be in another one.
struct Candidates {
  std::vector<int> vertices, triangles;
  std::vector<Ridge> ridges;
};

/// Of a mesh those that are in a box and, by `height` over its vertices, not below `least`.
Candidates candidates(const PlacedMesh& m, const Eigen::AlignedBox3d& box, const VecX<double>& height,
                      double least) {
  Candidates chosen;
  for (int k = 0; k < m.x.cols(); ++k)
    if (height[k] >= least && box.contains(m.x.col(k))) chosen.vertices.push_back(k);
  for (const ContactMesh::Edge& e : m.mesh->edges()) {
    if (std::max(height[e.from], height[e.to]) < least || e.right < 0) continue;
    const Vec3<double> from = m.x.col(e.from), to = m.x.col(e.to);
    if ((from.cwiseMax(to).array() < box.min().array()).any() ||
        (from.cwiseMin(to).array() > box.max().array()).any())
      continue;
    const Vec3<double> left = m.normal.col(e.left), right = m.normal.col(e.right);
    if (left.cross(right).dot(to - from) > kFlat * (to - from).norm())
      chosen.ridges.push_back({e.from, e.to, left, right});
  }
  const Eigen::Matrix3Xi& triangles = m.mesh->triangles();
  for (int t = 0; t < triangles.cols(); ++t) {
    const auto corner = triangles.col(t);
    if (std::max({height[corner[0]], height[corner[1]], height[corner[2]]}) < least) continue;
    const Vec3<double> p0 = m.x.col(corner[0]), p1 = m.x.col(corner[1]), p2 = m.x.col(corner[2]);
    if ((p0.cwiseMax(p1).cwiseMax(p2).array() < box.min().array()).any() ||
        (p0.cwiseMin(p1).cwiseMin(p2).array() > box.max().array()).any())
      continue;
    chosen.triangles.push_back(t);
  }
  return chosen;
}

/// Vertices of one mesh, at these places, that are inside the other. one_is_a: which is which in what is
/// found.
void vertices_inside(const Eigen::Matrix3Xd& one, const std::vector<int>& vertices, const PlacedMesh& other,
                     const std::vector<int>& triangles, bool one_is_a, std::vector<MeshTouch>& found) {
  for (const int k : vertices) {
    const Vec3<double> x = one.col(k);
    double nearest = std::numeric_limits<double>::infinity(), gap = 0;
    int which = -1;
    Vec3<double> weight;
    for (const int t : triangles) {
      const auto corner = other.mesh->triangles().col(t);
      const Vec3<double> p0 = other.x.col(corner[0]);
      const double height = other.normal.col(t).dot(x - p0);
      if (height * height > nearest * (1 + kTie)) continue;
      const Vec3<double> p1 = other.x.col(corner[1]), p2 = other.x.col(corner[2]);
      const Vec3<double> w = nearest_weights(x, p0, p1, p2);
      const double distance = (w[0] * p0 + w[1] * p1 + w[2] * p2 - x).squaredNorm();
      // Where several are as near, the one that x stands highest over or below tells inside from outside.
      const bool nearer = distance < nearest * (1 - kTie);
      if (!nearer && !(distance < nearest * (1 + kTie) && std::abs(height) > std::abs(gap))) continue;
      nearest = distance;
      gap = height;
      which = t;
      weight = w;
    }
    if (which < 0 || !(gap < 0) || !(nearest <= gap * gap * (1 + kStraight))) continue;
    MeshTouch touch;
    MeshPoint point, face;
    point.vertex[0] = k;
    const auto corner = other.mesh->triangles().col(which);
    face.vertex = {corner[0], corner[1], corner[2]};
    face.weight = weight;
    touch.a = one_is_a ? point : face;
    touch.b = one_is_a ? face : point;
    touch.x = x;
    touch.normal = one_is_a ? other.normal.col(which) : Vec3<double>(-other.normal.col(which));
    touch.gap = gap;
    found.push_back(touch);
  }
}

/// Edges of a and b that have gone across each other: of convex surfaces those whose normals, those of b
/// turned round, cross on the sphere, so that their distance is one of the bodies.
void edges_across(const Eigen::Matrix3Xd& a, const std::vector<Ridge>& ridges_a, const Eigen::Matrix3Xd& b,
                  const std::vector<Ridge>& ridges_b, std::vector<MeshTouch>& found) {
  for (const Ridge& e : ridges_a) {
    const Vec3<double>&n1 = e.left, &n2 = e.right;
    const Vec3<double> n21 = n2.cross(n1), p = a.col(e.from), along = a.col(e.to) - p;
    for (const Ridge& f : ridges_b) {
      const Vec3<double> m1 = -f.left, m2 = -f.right;
      const double above_1 = m1.dot(n21), above_2 = m2.dot(n21);
      if (!(above_1 * above_2 < 0)) continue;
      const Vec3<double> m21 = m2.cross(m1);
      const double beside_1 = n1.dot(m21), beside_2 = n2.dot(m21);
      if (!(beside_1 * beside_2 < 0 && above_1 * beside_2 > 0)) continue;
      const Vec3<double> r = b.col(f.from), way = b.col(f.to) - r;
      Vec3<double> normal = along.cross(way);
      const double across = normal.norm(), length = std::min(along.norm(), way.norm());
      if (!(across > kParallel * along.norm() * way.norm())) continue;
      normal /= normal.dot(m1 + m2) < 0 ? across : -across;
      const Vec3<double> d = p - r;
      const double gap = normal.dot(d);
      if (!(gap < 0 && gap > -kEdgeDepth * length)) continue;
      // The feet of the common perpendicular.
      const double aa = along.dot(along), ab = along.dot(way), bb = way.dot(way), det = aa * bb - ab * ab;
      const double s = (ab * way.dot(d) - bb * along.dot(d)) / det,
                   u = (aa * way.dot(d) - ab * along.dot(d)) / det;
      if (!(s >= 0 && s <= 1 && u >= 0 && u <= 1)) continue;
      MeshTouch touch;
      touch.a.vertex = {e.from, e.to, -1};
      touch.a.weight = {1 - s, s, 0};
      touch.b.vertex = {f.from, f.to, -1};
      touch.b.weight = {1 - u, u, 0};
      touch.x = p + s * along;
      touch.normal = normal;
      touch.gap = gap;
      found.push_back(touch);
    }
  }
}

/// Whether a point of a triangle, told by its weights, is on an edge or a corner from which nothing sticks
/// out: behind it there are points that are behind no triangle.
bool is_in_valley(const ObstacleMesh& m, int triangle, const Vec3<double>& weight) {
  std::array<int, 3> on{};
  std::size_t n = 0;
  for (int k = 0; k < 3; ++k)
    if (weight[k] > 0) on[n++] = k;
  if (n == 1) return m.corner(m.triangles()(on[0], triangle)).empty();
  if (n == 3) return false;
  const std::size_t edge = on[0] == 0 && on[1] == 2 ? 2 : static_cast<std::size_t>(on[0]);
  return !m.edges()[static_cast<std::size_t>(m.edges_of(triangle)[edge])].sharp;
}

/// Vertices of a that are behind triangles that they are turned towards.
void vertices_behind(const PlacedMesh& a, const ObstacleMesh& b, const std::vector<int>& triangles,
                     std::vector<MeshTouch>& found) {
  Eigen::Matrix3Xd out = Eigen::Matrix3Xd::Zero(3, a.x.cols());
  for (Eigen::Index t = 0; t < a.normal.cols(); ++t)
    for (Eigen::Index k = 0; k < 3; ++k) out.col(a.mesh->triangles()(k, t)) += a.normal.col(t);
  for (int k = 0; k < a.x.cols(); ++k) {
    const Vec3<double> x = a.x.col(k);
    double nearest = std::numeric_limits<double>::infinity(), gap = 0;
    int which = -1;
    Vec3<double> foot, weight;
    for (const int t : triangles) {
      const Vec3<double> normal = b.normal(t);
      if (normal.dot(out.col(k)) >= 0) continue;
      const auto corner = b.triangles().col(t);
      const Vec3<double> p0 = b.vertices().col(corner[0]);
      const double height = normal.dot(x - p0);
      if (height * height > nearest * (1 + kTie)) continue;
      const Vec3<double> p1 = b.vertices().col(corner[1]), p2 = b.vertices().col(corner[2]);
      const Vec3<double> w = nearest_weights(x, p0, p1, p2), there = w[0] * p0 + w[1] * p1 + w[2] * p2;
      const double distance = (there - x).squaredNorm();
      const bool nearer = distance < nearest * (1 - kTie);
      if (!nearer && !(distance < nearest * (1 + kTie) && std::abs(height) > std::abs(gap))) continue;
      nearest = distance;
      gap = height;
      which = t;
      foot = there;
      weight = w;
    }
    if (which < 0 || !(gap < 0)) continue;
    MeshTouch touch;
    touch.a.vertex[0] = k;
    touch.x = x;
    touch.gap = gap;
    touch.normal = b.normal(which);
    if (nearest > gap * gap * (1 + kStraight)) {
      if (!is_in_valley(b, which, weight)) continue;
      touch.gap = -std::sqrt(nearest);
      touch.normal = (x - foot) / touch.gap;
    }
    found.push_back(touch);
  }
}

/// What sticks out of some triangles of an obstacle; a border does to its side, both sides of a plate to
/// their front and back.
struct Sharp {
  std::vector<int> corners;
  std::vector<Ridge> ridges;
};

Sharp sharp_of(const ObstacleMesh& m, const std::vector<int>& triangles) {
  Sharp sharp;
  std::vector<int> edges;
  for (const int t : triangles)
    for (const int e : m.edges_of(t))
      if (m.edges()[static_cast<std::size_t>(e)].sharp) edges.push_back(e);
  auto once = [](std::vector<int>& some) {
    std::sort(some.begin(), some.end());
    some.erase(std::unique(some.begin(), some.end()), some.end());
  };
  once(edges);
  for (const int number : edges) {
    const ObstacleMesh::Edge& e = m.edges()[static_cast<std::size_t>(number)];
    const Vec3<double> left = m.normal(e.triangle[0]), out = m.along(e).cross(left);
    for (const int v : e.vertex) sharp.corners.push_back(v);
    if (e.triangle[1] >= 0 && left.dot(m.normal(e.triangle[1])) > kBackToBack) {
      sharp.ridges.push_back({e.vertex[0], e.vertex[1], left, m.normal(e.triangle[1])});
      continue;
    }
    sharp.ridges.push_back({e.vertex[0], e.vertex[1], left, out});
    if (e.triangle[1] >= 0) sharp.ridges.push_back({e.vertex[0], e.vertex[1], out, m.normal(e.triangle[1])});
  }
  once(sharp.corners);
  return sharp;
}

}  // namespace

PlacedMesh::PlacedMesh(const ContactMesh& of, Eigen::Matrix3Xd at)
    : mesh(&of), x(std::move(at)), normal(3, of.triangles().cols()) {
  box = Eigen::AlignedBox3d(x.rowwise().minCoeff(), x.rowwise().maxCoeff());
  for (Eigen::Index t = 0; t < normal.cols(); ++t) {
    const auto corner = of.triangles().col(t);
    const Vec3<double> p0 = x.col(corner[0]), p1 = x.col(corner[1]), p2 = x.col(corner[2]);
    normal.col(t) = (p1 - p0).cross(p2 - p0).normalized();
  }
}

void find_touches(const PlacedMesh& a, const PlacedMesh& b, std::vector<MeshTouch>& found) {
  if (!a.box.intersects(b.box)) return;
  // Nothing of a that is behind all of b touches it, whatever the direction; the same the other way round.
  const Vec3<double> towards = (b.box.center() - a.box.center()).normalized();
  const VecX<double> along_a = a.x.transpose() * towards, along_b = b.x.transpose() * towards;
  const double end_of_a = along_a.maxCoeff(), start_of_b = along_b.minCoeff();
  if (end_of_a < start_of_b) return;
  const Candidates of_a = candidates(a, b.box, along_a, start_of_b);
  const Candidates of_b = candidates(b, a.box, -along_b, -end_of_a);
  vertices_inside(a.x, of_a.vertices, b, of_b.triangles, true, found);
  vertices_inside(b.x, of_b.vertices, a, of_a.triangles, false, found);
  edges_across(a.x, of_a.ridges, b.x, of_b.ridges, found);
}

void find_touches(const PlacedMesh& a, const ObstacleMesh& b, double deepest, std::vector<MeshTouch>& found) {
  const double margin = kMargin * deepest;
  const Eigen::AlignedBox3d around(a.box.min().array() - margin, a.box.max().array() + margin);
  std::vector<int> near;
  if (!around.intersects(b.box())) return;
  b.query(around, near);
  if (near.empty()) return;
  const std::size_t first = found.size();
  vertices_behind(a, b, near, found);
  const Sharp sharp = sharp_of(b, near);
  if (!sharp.ridges.empty()) {
    Eigen::AlignedBox3d box;
    for (const Ridge& ridge : sharp.ridges)
      box.extend(b.vertices().col(ridge.from)).extend(b.vertices().col(ridge.to));
    const Candidates of_a = candidates(a, box, VecX<double>::Zero(a.x.cols()), 0);
    edges_across(a.x, of_a.ridges, b.vertices(), sharp.ridges, found);
    std::vector<int> all(static_cast<std::size_t>(a.mesh->triangles().cols()));
    std::iota(all.begin(), all.end(), 0);
    const std::size_t before = found.size();
    vertices_inside(b.vertices(), sharp.corners, a, all, false, found);
    found.erase(std::remove_if(found.begin() + static_cast<std::ptrdiff_t>(before), found.end(),
                               [&](const MeshTouch& touch) {
                                 return !b.leads_out(touch.b.vertex[0], touch.normal, kOut);
                               }),
                found.end());
  }
  found.erase(std::remove_if(found.begin() + static_cast<std::ptrdiff_t>(first), found.end(),
                             [&](const MeshTouch& touch) { return touch.gap < -deepest; }),
              found.end());
}

}  // namespace pliant
