// Disjoint sets of the integers 0 ... n - 1. Two integers are in one set if a chain of calls of unite()
// connects them. Searches shorten their paths by path halving (Tarjan and van Leeuwen 1984).
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace pliant {

/// A partition of 0 ... n - 1. At first each element is a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), 0); }

  /// Returns the smallest element of the set that contains i.
  int root(int i) {
    while (parent(i) != i) i = parent(i) = parent(parent(i));
    return i;
  }
  /// Merges the set of i and the set of j.
  void unite(int i, int j) {
    const int one = root(i), other = root(j);
    parent(one < other ? other : one) = one < other ? one : other;
  }

 private:
  int& parent(int i) { return parent_[static_cast<std::size_t>(i)]; }
  std::vector<int> parent_;
};

}  // namespace pliant
