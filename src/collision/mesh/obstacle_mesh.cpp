// Checks of an obstacle mesh, the separation of solids that touch (triangle_neighbours.h), its edges, faces
// and sharp edges, its tree of boxes, and queries.
#include <pliant/collision/mesh/obstacle_mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

#include <pliant/collision/mesh/triangle_neighbours.h>

namespace pliant {

namespace {

/// Triangles are in one plane if their vertices are at most kSamePlane from the plane, in diagonals of the
/// box of the mesh, and their normals differ by at most kOnePlaneNormal.
constexpr double kSamePlane = 4e-7, kOnePlaneNormal = 1e-4;
constexpr int kTrianglesInLeaf = 4;

std::string place(const Vec3<double>& x) {
  std::ostringstream text;
  text << "(" << x[0] << ", " << x[1] << ", " << x[2] << ")";
  return text.str();
}

[[noreturn]] void fail_mesh(const std::string& what) {
  throw std::invalid_argument(what);
}

/// Throws the error of an edge whose triangles do not form pairs. a, b: vertices of the edge.
[[noreturn]] void refuse_edge(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles, int a, int b) {
  std::vector<int> at_edge;
  std::vector<bool> forward;
  for (int t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int from = triangles(k, t), to = triangles((k + 1) % 3, t);
      if (std::minmax(from, to) != std::minmax(a, b)) continue;
      at_edge.push_back(t);
      forward.push_back(from == a);
    }
  const std::string edge = "the edge from " + place(x.col(a)) + " to " + place(x.col(b)),
                    one = std::to_string(at_edge[0]), other = std::to_string(at_edge[1]);
  if (forward[0] == forward[1])
    fail_mesh("triangles " + one + " and " + other + " have opposite orientations at " + edge);
  fail_mesh(edge + " has three triangles: " + one + ", " + other + " and " + std::to_string(at_edge[2]));
}

}  // namespace

ObstacleMesh::ObstacleMesh(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
  if (triangles.cols() == 0) fail_mesh("it has no triangles");
  weld(vertices, triangles);
  build_edges();
  order_.resize(at(static_cast<int>(triangles_.cols())));
  for (std::size_t t = 0; t < order_.size(); ++t) order_[t] = static_cast<int>(t);
  build_tree(0, static_cast<int>(order_.size()));
  build_faces();
  mark_sharp();
}

void ObstacleMesh::weld(const Eigen::Matrix3Xd& vertices, const Eigen::Matrix3Xi& triangles) {
  std::map<std::array<double, 3>, int> number_at;
  std::vector<int> number;
  std::vector<Eigen::Index> first;  // for each merged vertex, its first vertex in the input
  for (Eigen::Index i = 0; i < vertices.cols(); ++i) {
    const Vec3<double> x = vertices.col(i);
    if (!x.allFinite()) fail_mesh("vertex " + std::to_string(i) + " is not finite: " + place(x));
    const auto [entry, is_new] =
        number_at.try_emplace({x[0] + 0.0, x[1] + 0.0, x[2] + 0.0}, static_cast<int>(first.size()));
    if (is_new) first.push_back(i);
    number.push_back(entry->second);
  }
  x_.resize(3, static_cast<Eigen::Index>(first.size()));
  for (std::size_t k = 0; k < first.size(); ++k)
    x_.col(static_cast<Eigen::Index>(k)) = vertices.col(first[k]);
  triangles_.resize(3, triangles.cols());
  normals_.resize(3, triangles.cols());
  std::vector<bool> used(first.size());
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    std::array<Vec3<double>, 3> corner;
    for (int k = 0; k < 3; ++k) {
      const int i = triangles(k, t);
      if (i < 0 || i >= vertices.cols())
        fail_mesh("triangle " + std::to_string(t) + " names vertex " + std::to_string(i) +
                  ", but the number of vertices is " + std::to_string(vertices.cols()));
      triangles_(k, t) = number[at(i)];
      used[at(number[at(i)])] = true;
      corner[at(k)] = vertices.col(i);
    }
    const Vec3<double> a = corner[1] - corner[0], b = corner[2] - corner[0];
    const Vec3<double> across = a.cross(b);
    const double longest = std::max({a.norm(), b.norm(), (corner[2] - corner[1]).norm()});
    if (!(across.norm() > kNoHeight * longest * longest))
      fail_mesh("triangle " + std::to_string(t) + " has no area: its corners are " + place(corner[0]) + ", " +
                place(corner[1]) + " and " + place(corner[2]));
    normals_.col(t) = across.normalized();
  }
  for (std::size_t k = 0; k < used.size(); ++k)
    if (!used[k])
      fail_mesh("vertex " + std::to_string(first[k]) +
                " is in no triangle: " + place(x_.col(static_cast<Eigen::Index>(k))));
  separate_touching(x_, triangles_);
}

void ObstacleMesh::build_edges() {
  const TriangleNeighbours neighbours(x_, triangles_);
  edges_of_.assign(at(static_cast<int>(triangles_.cols())), {-1, -1, -1});
  for (int t = 0; t < triangles_.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      int& number = edges_of_[at(t)][at(k)];
      if (number >= 0) continue;  // a triangle before this one has the edge
      number = static_cast<int>(edges_.size());
      const int a = triangles_(k, t), b = triangles_((k + 1) % 3, t), other = neighbours.across[at(t)][at(k)];
      if (other == TriangleNeighbours::kConflict) refuse_edge(x_, triangles_, a, b);
      edges_.push_back({{a, b}, {t, other}, true});
      if (other < 0) continue;
      for (int l = 0; l < 3; ++l)
        if (triangles_(l, other) == b && triangles_((l + 1) % 3, other) == a)
          edges_of_[at(other)][at(l)] = number;
    }
  closed_ = std::all_of(edges_.begin(), edges_.end(), [](const Edge& e) { return e.triangle[1] >= 0; });
}

void ObstacleMesh::build_tree(int first, int count) {
  Node node{{}, first, count, 0};
  for (int i = first; i < first + count; ++i)
    for (int k = 0; k < 3; ++k) node.box.extend(x_.col(triangles_(k, order_[at(i)])));
  const std::size_t here = nodes_.size();
  nodes_.push_back(node);
  if (count <= kTrianglesInLeaf) return;
  Eigen::Index axis = 0;
  node.box.sizes().maxCoeff(&axis);
  auto middle = [&](int t) {
    return x_(axis, triangles_(0, t)) + x_(axis, triangles_(1, t)) + x_(axis, triangles_(2, t));
  };
  const auto begin = order_.begin() + first;
  const int half = count / 2;
  std::nth_element(begin, begin + half, begin + count,
                   [&](int i, int j) { return std::pair(middle(i), i) < std::pair(middle(j), j); });
  nodes_[here].count = 0;
  build_tree(first, half);
  nodes_[here].second = static_cast<int>(nodes_.size());
  build_tree(first + half, count - half);
}

void ObstacleMesh::build_faces() {
  const double near = kSamePlane * box().diagonal().norm();
  face_of_.assign(edges_of_.size(), -1);
  std::vector<int> open;
  for (int t = 0; t < triangles_.cols(); ++t) {
    if (face_of_[at(t)] >= 0) continue;
    const int number = static_cast<int>(faces_.size());
    const Face face{x_.col(triangles_(0, t)), normal(t)};
    faces_.push_back(face);
    face_of_[at(t)] = number;
    open.assign(1, t);
    while (!open.empty()) {
      const int from = open.back();
      open.pop_back();
      for (const int e : edges_of_[at(from)]) {
        const std::array<int, 2>& sides = edges_[at(e)].triangle;
        const int to = sides[0] == from ? sides[1] : sides[0];
        if (to < 0 || face_of_[at(to)] >= 0 || (normal(to) - face.normal).norm() > kOnePlaneNormal) continue;
        bool flat = true;
        for (int k = 0; k < 3; ++k)
          flat = flat && std::abs(face.normal.dot(x_.col(triangles_(k, to)) - face.point)) <= near;
        if (!flat) continue;
        face_of_[at(to)] = number;
        open.push_back(to);
      }
    }
  }
}

void ObstacleMesh::mark_sharp() {
  corners_.resize(at(static_cast<int>(x_.cols())));
  for (Edge& edge : edges_) {
    if (edge.triangle[1] < 0) continue;
    const Vec3<double> n = normal(edge.triangle[0]), m = normal(edge.triangle[1]);
    const double sine = n.cross(m).dot(along(edge));
    // The two sides of a plate coincide; an edge between them is a ridge too.
    edge.sharp = face_of_[at(edge.triangle[0])] != face_of_[at(edge.triangle[1])] &&
                 (sine > 0 || (n.dot(m) < 0 && sine > -kOnePlaneNormal));
  }
  for (std::size_t e = 0; e < edges_.size(); ++e)
    for (const int v : edges_[e].vertex) corners_[at(v)].push_back(static_cast<int>(e));
  for (std::vector<int>& corner : corners_)
    if (std::none_of(corner.begin(), corner.end(), [&](int e) { return edges_[at(e)].sharp; }))
      corner.clear();
}

bool ObstacleMesh::points_outward(const Edge& edge, const Vec3<double>& direction, double sine) const {
  const Vec3<double> e = along(edge);
  if (direction.dot(e.cross(normal(edge.triangle[0]))) < -sine) return false;
  if (edge.triangle[1] < 0) return direction.dot(normal(edge.triangle[0])) >= -sine;
  return direction.dot(normal(edge.triangle[1]).cross(e)) >= -sine;
}

bool ObstacleMesh::points_outward(int vertex, const Vec3<double>& direction, double sine) const {
  const std::vector<int>& meet = corner(vertex);
  return std::all_of(meet.begin(), meet.end(), [&](int number) {
    const Edge& edge = edges_[at(number)];
    const double way = edge.vertex[0] == vertex ? direction.dot(along(edge)) : -direction.dot(along(edge));
    return way <= sine && (edge.triangle[1] >= 0 || direction.dot(normal(edge.triangle[0])) >= -sine);
  });
}

void ObstacleMesh::query(const Eigen::AlignedBox3d& box, std::vector<int>& found) const {
  found.clear();
  std::array<int, 64>
      open;  // the tree halves its triangles, so its depth is at most the number of bits of an int
  std::size_t n_open = 0;
  open[n_open++] = 0;
  while (n_open > 0) {
    const int here = open[--n_open];
    const Node& node = nodes_[at(here)];
    if (!node.box.intersects(box)) continue;
    if (node.count == 0) {
      open[n_open++] = here + 1;
      open[n_open++] = node.second;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      Eigen::AlignedBox3d own;
      for (int k = 0; k < 3; ++k) own.extend(x_.col(triangles_(k, order_[at(i)])));
      if (own.intersects(box)) found.push_back(order_[at(i)]);
    }
  }
  std::sort(found.begin(), found.end());
}

Vec3<double> ObstacleMesh::nearest(int triangle, const Vec3<double>& x) const {
  const Vec3<double> n = normal(triangle);
  Vec3<double> best = x - n.dot(x - x_.col(triangles_(0, triangle))) * n;
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 3; ++k) {
    const Vec3<double> a = x_.col(triangles_(k, triangle)), e = x_.col(triangles_((k + 1) % 3, triangle)) - a;
    if (n.dot(e.cross(x - a)) >= 0) continue;
    const Vec3<double> on = a + std::clamp(e.dot(x - a) / e.squaredNorm(), 0.0, 1.0) * e;
    if ((x - on).squaredNorm() >= least) continue;
    least = (x - on).squaredNorm();
    best = on;
  }
  return best;
}

bool ObstacleMesh::is_within(const Vec3<double>& x, double distance) const {
  if (box().squaredExteriorDistance(x) > distance * distance) return false;
  std::vector<int> near;
  query({(x.array() - distance).matrix(), (x.array() + distance).matrix()}, near);
  return std::any_of(near.begin(), near.end(), [&](int t) { return (nearest(t, x) - x).norm() <= distance; });
}

}  // namespace pliant
