// A tree over axis-aligned boxes that finds all pairs of nearby boxes. A node with more than four boxes is
// split at the median of their centres, along the longest side of the box that contains these centres. The
// cost is O(n log n) for boxes of any sizes unless many boxes overlap each other.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace pliant {

class BoxTree {
 public:
  /// Builds the tree. boxes: must outlive all later queries.
  void build(const std::vector<Eigen::AlignedBox3d>& boxes);
  /// Computes all pairs (i, j), i < j, of numbers of boxes that are at most max_distance (m) apart, sorted by
  /// i and then j. `pairs` is overwritten.
  void near_pairs(double max_distance, std::vector<std::pair<int, int>>& pairs) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first, last;  ///< range [first, last) of order_
    int right = -1;   ///< index of the second child; -1 for a leaf; the first child follows its parent
  };
  int split(int first, int last);
  template <class F>
  void within(int node, double square, F& found) const;
  template <class F>
  void between(int a, int b, double square, F& found) const;

  const std::vector<Eigen::AlignedBox3d>* boxes_ = nullptr;
  std::vector<int> order_;
  std::vector<Node> nodes_;
};

}  // namespace pliant
