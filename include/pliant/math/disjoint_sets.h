// What is tied together, directly or through others: disjoint sets of the numbers from 0 on, with path
// halving (Tarjan and van Leeuwen 1984).
#pragma once

#include <cstddef>
#include <numeric>
#include <vector>

namespace pliant {

class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : leader_(n) { std::iota(leader_.begin(), leader_.end(), 0); }

  /// The least number of a set.
  int leader(int i) {
    while (of(i) != i) i = of(i) = of(of(i));
    return i;
  }
  void unite(int i, int j) {
    const int one = leader(i), other = leader(j);
    of(one < other ? other : one) = one < other ? one : other;
  }

 private:
  int& of(int i) { return leader_[static_cast<std::size_t>(i)]; }
  std::vector<int> leader_;
};

}  // namespace pliant
