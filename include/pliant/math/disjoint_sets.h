// Disjoint sets of the integers 0 ... n - 1: groups of elements that are connected directly or through
// others. Path halving (Tarjan and van Leeuwen 1984).
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace pliant {

/// A partition of 0 ... n - 1. At first each element is a set of its own.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : leader_(n) { std::iota(leader_.begin(), leader_.end(), 0); }

  /// Returns the smallest element of the set that contains i.
  int leader(int i) {
    while (of(i) != i) i = of(i) = of(of(i));
    return i;
  }
  /// Merges the set of i and the set of j.
  void unite(int i, int j) {
    const int one = leader(i), other = leader(j);
    of(one < other ? other : one) = one < other ? one : other;
  }

 private:
  int& of(int i) { return leader_[static_cast<std::size_t>(i)]; }
  std::vector<int> leader_;
};

}  // namespace pliant
