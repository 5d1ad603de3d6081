#include "clean_mesh.h"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include <pliant/collision/mesh/triangle_neighbours.h>
#include <pliant/math/disjoint_sets.h>
#include <pliant/math/index.h>

#include "scene/scene_faults.h"

namespace pliant {

namespace {

/// Smallest height of a triangle as a share of its longest edge. It is twice the limit of ObstacleMesh,
/// because the placement of a mesh rounds its vertices.
constexpr double kSliver = 2 * kNoHeight;
constexpr int kMaxPasses = 50;

using Triangle = std::array<int, 3>;

/// Returns a triangle with its smallest vertex first, in the same orientation.
Triangle turned(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}
Triangle reversed(const Triangle& t) {
  return turned({t[0], t[2], t[1]});
}

class MeshCleaner {
 public:
  explicit MeshCleaner(RawMesh raw) : notes_(std::move(raw.notes)) {
    merge_positions(raw);
    remove_flat();
    note(n_flat_, "triangle with two equal corners is", "triangles with two equal corners are", " removed");
    remove_copies();
    note(n_copies_, "triangle is", "triangles are", " given more than once; one of each is kept");
    remove_slivers();
    note(n_slivers_, "sliver is", "slivers are",
         " removed (height below " + brief(kSliver) + " of the longest edge)");
    remove_walls();
    note(n_walls_, "pair of triangles between two touching solids is",
         "pairs of triangles between two touching solids are", " removed");
  }

  MeshFile result() {
    MeshFile mesh;
    mesh.triangles = matrix();
    drop_unused(mesh.triangles);
    mesh.vertices.resize(3, static_cast<Eigen::Index>(x_.size()));
    for (std::size_t i = 0; i < x_.size(); ++i) mesh.vertices.col(static_cast<Eigen::Index>(i)) = x_[i];
    note(at(TriangleNeighbours(mesh.vertices, mesh.triangles).touching_edges), "edge has", "edges have",
         " more than two triangles, where solids touch; each solid keeps its own edge");
    mesh.notes = std::move(notes_);
    return mesh;
  }

 private:
  void note(std::size_t n, const std::string& one, const std::string& many, const std::string& rest) {
    if (n > 0) notes_.push_back(counted(n, one, many) + rest);
  }

  /// Gives each distinct position one number, in the order of the file, and counts the vertices that no
  /// triangle uses.
  void merge_positions(const RawMesh& raw) {
    std::map<std::array<double, 3>, int> number_at;
    std::vector<int> number;
    for (const Vec3<double>& v : raw.vertices) {
      const auto [entry, is_new] =
          number_at.try_emplace({v[0] + 0.0, v[1] + 0.0, v[2] + 0.0}, static_cast<int>(x_.size()));
      if (is_new) x_.push_back(v);
      number.push_back(entry->second);
    }
    std::vector<bool> used(raw.vertices.size());
    for (const Triangle& t : raw.triangles) {
      for (const int corner : t) used[at(corner)] = true;
      triangles_.push_back({number[at(t[0])], number[at(t[1])], number[at(t[2])]});
    }
    note(static_cast<std::size_t>(std::count(used.begin(), used.end(), false)), "vertex is", "vertices are",
         " in no triangle and ignored");
  }

  void remove_flat() {
    const std::size_t before = triangles_.size();
    triangles_.erase(
        std::remove_if(triangles_.begin(), triangles_.end(),
                       [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }),
        triangles_.end());
    n_flat_ += before - triangles_.size();
  }

  void remove_copies() {
    std::set<Triangle> known;
    const std::size_t before = triangles_.size();
    triangles_.erase(std::remove_if(triangles_.begin(), triangles_.end(),
                                    [&](const Triangle& t) { return !known.insert(turned(t)).second; }),
                     triangles_.end());
    n_copies_ += before - triangles_.size();
  }

  /// Returns the corner k such that the edge from corner k to corner k + 1 is the longest one.
  std::size_t longest_edge(const Triangle& t) const {
    std::size_t longest = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (length(t, k) > length(t, longest)) longest = k;
    return longest;
  }
  double length(const Triangle& t, std::size_t k) const {
    return (x_[at(t[(k + 1) % 3])] - x_[at(t[k])]).norm();
  }
  bool is_sliver(const Triangle& t) const {
    const Vec3<double> a = x_[at(t[1])] - x_[at(t[0])], b = x_[at(t[2])] - x_[at(t[0])];
    const double longest = length(t, longest_edge(t));
    return !(a.cross(b).norm() > kSliver * longest * longest);
  }

  /// Each pass removes slivers that do not touch each other. ObstacleMesh refuses slivers that remain after
  /// kMaxPasses passes.
  void remove_slivers() {
    for (int pass = 0; pass < kMaxPasses; ++pass) {
      std::vector<std::size_t> slivers;
      for (std::size_t t = 0; t < triangles_.size(); ++t)
        if (is_sliver(triangles_[t])) slivers.push_back(t);
      if (slivers.empty()) return;
      remove_some(slivers);
      const std::size_t flat = n_flat_, copies = n_copies_;
      remove_flat();
      remove_copies();
      n_flat_ = flat;
      n_copies_ = copies;
    }
  }

  void remove_some(const std::vector<std::size_t>& slivers) {
    std::map<std::pair<int, int>, std::size_t> triangle_at;  // by the vertices of an edge, in its direction
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        triangle_at.try_emplace({triangles_[t][k], triangles_[t][(k + 1) % 3]}, t);
    std::set<std::size_t> changed;
    std::vector<std::pair<int, int>> merged;
    for (const std::size_t t : slivers) {
      const Triangle sliver = triangles_[t];
      const std::size_t k = longest_edge(sliver);
      const int p = sliver[k], q = sliver[(k + 1) % 3], r = sliver[(k + 2) % 3];
      const double near = kSliver * length(sliver, k);
      const auto neighbour = triangle_at.find({q, p});
      if (changed.count(t) > 0) continue;
      if (length(sliver, (k + 1) % 3) <= near || length(sliver, (k + 2) % 3) <= near) {
        const int end = length(sliver, (k + 1) % 3) <= near ? q : p;
        merged.emplace_back(std::max(end, r), std::min(end, r));
      } else if (neighbour != triangle_at.end() && neighbour->second != t) {
        if (!changed.insert(neighbour->second).second) continue;
        divide(neighbour->second, q, p, r);
      }
      changed.insert(t);
      triangles_[t] = {p, p, p};  // removed as a triangle with equal corners
      ++n_slivers_;
    }
    merge_vertices(merged);
  }

  /// Divides triangle t, which has the edge from q to p, into two triangles with the common vertex r.
  void divide(std::size_t t, int q, int p, int r) {
    const Triangle whole = triangles_[t];
    const int s = whole[0] != q && whole[0] != p   ? whole[0]
                  : whole[1] != q && whole[1] != p ? whole[1]
                                                   : whole[2];
    triangles_[t] = {q, r, s};
    triangles_.push_back({r, p, s});
  }

  void merge_vertices(const std::vector<std::pair<int, int>>& merged) {
    if (merged.empty()) return;
    DisjointSets sets(x_.size());
    for (const auto& [a, b] : merged) sets.unite(a, b);
    for (Triangle& t : triangles_)
      for (int& corner : t) corner = sets.root(corner);
  }

  void remove_walls() {
    std::set<Triangle> known;
    for (const Triangle& t : triangles_) known.insert(turned(t));
    const auto has_twin = [&](const Triangle& t) { return known.count(reversed(t)) > 0; };
    if (std::none_of(triangles_.begin(), triangles_.end(), has_twin)) return;
    Eigen::Matrix3Xd x(3, static_cast<Eigen::Index>(x_.size()));
    for (std::size_t i = 0; i < x_.size(); ++i) x.col(static_cast<Eigen::Index>(i)) = x_[i];
    const TriangleNeighbours neighbours(x, matrix());
    DisjointSets solids(triangles_.size());
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (const int other : neighbours.across[t])
        if (other >= 0) solids.unite(static_cast<int>(t), other);
    std::map<Triangle, int> solid_of;
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      solid_of.emplace(turned(triangles_[t]), solids.root(static_cast<int>(t)));
    const std::size_t before = triangles_.size();
    triangles_.erase(std::remove_if(triangles_.begin(), triangles_.end(),
                                    [&](const Triangle& t) {
                                      const auto twin = solid_of.find(reversed(t));
                                      return twin != solid_of.end() && twin->second != solid_of.at(turned(t));
                                    }),
                     triangles_.end());
    n_walls_ = (before - triangles_.size()) / 2;
  }

  Eigen::Matrix3Xi matrix() const {
    Eigen::Matrix3Xi all(3, static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        all(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(t)) = triangles_[t][k];
    return all;
  }

  /// Removes the positions that no triangle uses and renumbers the remaining positions.
  void drop_unused(Eigen::Matrix3Xi& triangles) {
    std::vector<int> number(x_.size(), -1);
    for (const int corner : triangles.reshaped()) number[at(corner)] = 0;
    int next = 0;
    for (std::size_t i = 0; i < x_.size(); ++i)
      if (number[i] == 0) {
        x_[at(next)] = x_[i];
        number[i] = next++;
      }
    x_.resize(at(next));
    for (int& corner : triangles.reshaped()) corner = number[at(corner)];
  }

  std::vector<Vec3<double>> x_;
  std::vector<Triangle> triangles_;
  std::vector<std::string> notes_;
  std::size_t n_flat_ = 0, n_copies_ = 0, n_slivers_ = 0, n_walls_ = 0;
};

}  // namespace

MeshFile clean_mesh(RawMesh raw) {
  return MeshCleaner(std::move(raw)).result();
}

}  // namespace pliant
