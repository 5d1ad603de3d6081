#include <pliant/collision/mesh/triangle_neighbours.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include <Eigen/Geometry>

#include <pliant/math/disjoint_sets.h>
#include <pliant/math/index.h>
#include <pliant/math/scalar/functions.h>

namespace pliant {

namespace {

/// An edge of a triangle, from its corner k to its corner k + 1.
struct HalfEdge {
  std::pair<int, int> ends;  ///< vertex numbers, the smaller one first
  int triangle, k;
  bool forward;  ///< whether the edge leads from the first to the second end
};

/// Returns the edges of all triangles, sorted by their ends, then by triangle.
std::vector<HalfEdge> sorted_edges(const Eigen::Matrix3Xi& triangles) {
  std::vector<HalfEdge> all;
  all.reserve(3 * at(static_cast<int>(triangles.cols())));
  for (int t = 0; t < triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = triangles(k, t), b = triangles((k + 1) % 3, t);
      all.push_back({std::minmax(a, b), t, k, a < b});
    }
  std::stable_sort(all.begin(), all.end(),
                   [](const HalfEdge& a, const HalfEdge& b) { return a.ends < b.ends; });
  return all;
}

/// Calls act(first, last) for the edges with equal ends.
template <class Act>
void for_each_edge(const std::vector<HalfEdge>& all, Act&& act) {
  for (std::size_t first = 0, last = 0; first < all.size(); first = last) {
    while (last < all.size() && all[last].ends == all[first].ends) ++last;
    act(first, last);
  }
}

/// Returns the angle (rad) by which a triangle is turned about one of its edges. Triangles with a common edge
/// have the same zero direction.
double angle_about(const HalfEdge& edge, const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles) {
  const Vec3<double> a = x.col(edge.ends.first), e = (Vec3<double>(x.col(edge.ends.second)) - a).normalized();
  Eigen::Index smallest = 0;
  e.cwiseAbs().minCoeff(&smallest);
  const Vec3<double> u = e.cross(Vec3<double>::Unit(smallest)).normalized(), v = e.cross(u);
  const Vec3<double> apex = Vec3<double>(x.col(triangles((edge.k + 2) % 3, edge.triangle))) - a;
  return std::atan2(apex.dot(v), apex.dot(u));
}

/// Returns the number of the partner of each of the half edges first to last - 1, or an empty list if they do
/// not form pairs.
std::vector<std::size_t> find_pairs(const std::vector<HalfEdge>& all, std::size_t first, std::size_t last,
                                    const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles) {
  constexpr double same_plane = 1e-9;  // rad; two triangles in one place do not bound a solid
  std::vector<double> angle;
  for (std::size_t i = first; i < last; ++i) angle.push_back(angle_about(all[i], x, triangles));
  const std::size_t none = last;
  std::vector<std::size_t> partner(last - first, none);
  for (std::size_t i = first; i < last; ++i) {
    if (!all[i].forward) continue;
    double least = 4 * kPi;
    std::size_t best = none;
    for (std::size_t j = first; j < last; ++j) {
      if (all[j].forward) continue;
      double turn = angle[i - first] - angle[j - first];  // into the solid of triangle i
      while (turn < same_plane) turn += 2 * kPi;
      if (turn >= least) continue;
      least = turn;
      best = j;
    }
    if (best == none || partner[best - first] != none) return {};
    partner[i - first] = best;
    partner[best - first] = i;
  }
  if (std::find(partner.begin(), partner.end(), none) != partner.end()) return {};
  return partner;
}

}  // namespace

TriangleNeighbours::TriangleNeighbours(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles)
    : across(at(static_cast<int>(triangles.cols())), {kBorder, kBorder, kBorder}) {
  const std::vector<HalfEdge> all = sorted_edges(triangles);
  const auto other_side = [&](const HalfEdge& edge) -> int& { return across[at(edge.triangle)][at(edge.k)]; };
  for_each_edge(all, [&](std::size_t first, std::size_t last) {
    if (last == first + 1) return;
    if (last == first + 2 && all[first].forward != all[first + 1].forward) {
      other_side(all[first]) = all[first + 1].triangle;
      other_side(all[first + 1]) = all[first].triangle;
      return;
    }
    const std::vector<std::size_t> partner = find_pairs(all, first, last, x, triangles);
    for (std::size_t i = first; i < last; ++i)
      other_side(all[i]) = partner.empty() ? kConflict : all[partner[i - first]].triangle;
    if (!partner.empty()) ++touching_edges;
  });
}

void separate_touching(Eigen::Matrix3Xd& x, Eigen::Matrix3Xi& triangles) {
  const TriangleNeighbours neighbours(x, triangles);
  const int n = static_cast<int>(triangles.cols());
  DisjointSets corners(3 * at(n));  // corner k of triangle t is element 3 t + k
  const auto corner_at = [&](int t, int vertex) {
    for (int k = 0; k < 2; ++k)
      if (triangles(k, t) == vertex) return 3 * t + k;
    return 3 * t + 2;
  };
  std::map<std::pair<int, int>, int> conflict;  // a triangle of each edge in conflict
  for (int t = 0; t < n; ++t)
    for (int k = 0; k < 3; ++k) {
      int other = neighbours.across[at(t)][at(k)];
      const int a = triangles(k, t), b = triangles((k + 1) % 3, t);
      if (other == TriangleNeighbours::kConflict)
        other = conflict.try_emplace(std::minmax(a, b), t).first->second;
      if (other < 0) continue;
      for (const int vertex : {a, b}) corners.unite(corner_at(t, vertex), corner_at(other, vertex));
    }
  std::vector<int> first_set(at(static_cast<int>(x.cols())), -1);  // set of corners that keeps each vertex
  std::map<int, int> copy;                                         // copied vertex of each further set
  std::vector<int> source;                                         // original vertex of each copy
  Eigen::Matrix3Xi separate = triangles;
  for (int t = 0; t < n; ++t)
    for (int k = 0; k < 3; ++k) {
      const int vertex = triangles(k, t), set = corners.root(3 * t + k);
      int& keeps = first_set[at(vertex)];
      if (keeps < 0) keeps = set;
      if (keeps == set) continue;
      const auto [entry, is_new] =
          copy.try_emplace(set, static_cast<int>(x.cols()) + static_cast<int>(source.size()));
      if (is_new) source.push_back(vertex);
      separate(k, t) = entry->second;
    }
  if (source.empty()) return;
  const Eigen::Index before = x.cols();
  x.conservativeResize(3, before + static_cast<Eigen::Index>(source.size()));
  for (std::size_t i = 0; i < source.size(); ++i)
    x.col(before + static_cast<Eigen::Index>(i)) = x.col(source[i]);
  triangles = separate;
}

}  // namespace pliant
