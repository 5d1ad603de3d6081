// Construction of the tree, and the traversal of pairs of nodes.
#include <pliant/collision/box_tree.h>

#include <algorithm>

#include <pliant/math/index.h>

namespace pliant {

namespace {

constexpr int kBoxesInLeaf = 4;

}  // namespace

void BoxTree::build(const std::vector<Eigen::AlignedBox3d>& boxes) {
  boxes_ = &boxes;
  const int n = static_cast<int>(boxes.size());
  order_.resize(boxes.size());
  for (int i = 0; i < n; ++i) order_[at(i)] = i;
  nodes_.clear();
  if (n > 0) split(0, n);
}

int BoxTree::split(int first, int last) {
  const int number = static_cast<int>(nodes_.size());
  Eigen::AlignedBox3d box, centres;
  for (int k = first; k < last; ++k) {
    box.extend((*boxes_)[at(order_[at(k)])]);
    centres.extend((*boxes_)[at(order_[at(k)])].center());
  }
  nodes_.push_back({box, first, last});
  if (last - first <= kBoxesInLeaf) return number;
  Eigen::Index axis;
  centres.sizes().maxCoeff(&axis);
  auto middle = [&](int i) { return (*boxes_)[at(i)].min()[axis] + (*boxes_)[at(i)].max()[axis]; };
  const int half = (first + last) / 2;
  std::nth_element(order_.begin() + first, order_.begin() + half, order_.begin() + last,
                   [&](int i, int j) { return std::pair(middle(i), i) < std::pair(middle(j), j); });
  split(first, half);
  const int right = split(half, last);
  nodes_[at(number)].right = right;
  return number;
}

template <class F>
void BoxTree::within(int node, double square, F& found) const {
  const Node& n = nodes_[at(node)];
  if (n.right >= 0) {
    within(node + 1, square, found);
    within(n.right, square, found);
    between(node + 1, n.right, square, found);
    return;
  }
  for (int k = n.first; k < n.last; ++k)
    for (int l = k + 1; l < n.last; ++l) found(order_[at(k)], order_[at(l)]);
}

template <class F>
void BoxTree::between(int a, int b, double square, F& found) const {
  const Node &one = nodes_[at(a)], &other = nodes_[at(b)];
  if (one.box.squaredExteriorDistance(other.box) > square) return;
  if (one.right >= 0 && (other.right < 0 || one.last - one.first >= other.last - other.first)) {
    between(a + 1, b, square, found);
    between(one.right, b, square, found);
  } else if (other.right >= 0) {
    between(a, b + 1, square, found);
    between(a, other.right, square, found);
  } else {
    for (int k = one.first; k < one.last; ++k)
      for (int l = other.first; l < other.last; ++l) found(order_[at(k)], order_[at(l)]);
  }
}

void BoxTree::near_pairs(double max_distance, std::vector<std::pair<int, int>>& pairs) const {
  pairs.clear();
  if (nodes_.empty()) return;
  const double square = max_distance * max_distance;
  auto found = [&](int i, int j) {
    if ((*boxes_)[at(i)].squaredExteriorDistance((*boxes_)[at(j)]) <= square)
      pairs.emplace_back(std::min(i, j), std::max(i, j));
  };
  within(0, square, found);
  std::sort(pairs.begin(), pairs.end());
}

}  // namespace pliant
