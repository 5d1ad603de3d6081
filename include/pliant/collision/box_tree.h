// Which of many boxes are near each other: a tree of boxes over boxes, split at the median along the longest
// side, O(n log n) for boxes of any sizes that do not crowd.
#pragma once

#include <utility>
#include <vector>

#include <Eigen/Geometry>

namespace pliant {

class BoxTree {
 public:
  /// The boxes must outlive what is asked of it.
  void build(const std::vector<Eigen::AlignedBox3d>& boxes);
  /// All pairs (i, j), i < j, whose boxes are no farther from each other than `most`, in order.
  void near_pairs(double most, std::vector<std::pair<int, int>>& pairs) const;

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    int first, last;  ///< its share of order_
    int right = -1;   ///< its second child; the first one follows it; -1: a leaf
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
