// Reading and writing of nodal values, four nodes at a time, as Packs. The values are columns of numbers, one
// number for each node.
#pragma once

#include <algorithm>
#include <cstring>

#include <pliant/math/scalar/pack.h>
#include <pliant/math/types.h>

namespace pliant {

/// Four consecutive nodes, or fewer at the end of the column. full: whether all four nodes exist; if full is
/// true, the compiler keeps sums over nodes in registers.
template <bool full = false>
class FourNodes {
 public:
  /// Selects the nodes first .. first + 3 that are below n.
  FourNodes(Eigen::Index first, Eigen::Index n)
      : first_(first), count_(static_cast<int>(std::min<Eigen::Index>(Pack::kLanes, n - first))) {}

  Eigen::Index first() const { return first_; }
  /// Returns the values of the nodes from a column of nodal values; lanes without a node are 0.
  [[gnu::always_inline]] Pack load(const double* column) const {
    if constexpr (!full)
      if (count_ != Pack::kLanes) return load_some(column + first_);
    Pack x;
    std::memcpy(x.vectors, column + first_, sizeof x.vectors);
    return x;
  }
  /// Writes the values of the nodes to a column of nodal values.
  [[gnu::always_inline]] void store(double* column, const Pack& x) const {
    if constexpr (!full)
      if (count_ != Pack::kLanes) return store_some(column + first_, x);
    std::memcpy(column + first_, x.vectors, sizeof x.vectors);
  }
  /// These overloads read and write vectors at the nodes. The vectors are stored in three columns of `rows`
  /// numbers, one column after the other.
  [[gnu::always_inline]] Vec3<Pack> load(const double* columns, Eigen::Index rows) const {
    return {load(columns), load(columns + rows), load(columns + 2 * rows)};
  }
  [[gnu::always_inline]] void store(double* columns, Eigen::Index rows, const Vec3<Pack>& x) const {
    for (int r = 0; r < 3; ++r) store(columns + r * rows, x[r]);
  }

 private:
  [[gnu::noinline]] Pack load_some(const double* from) const {
    return {from[0], count_ > 1 ? from[1] : 0.0, count_ > 2 ? from[2] : 0.0, 0.0};
  }
  [[gnu::noinline]] void store_some(double* to, const Pack& x) const {
    for (int i = 0; i < count_; ++i) to[i] = x[i];
  }

  Eigen::Index first_;
  int count_;
};

/// Calls act(four) once for every four of the n nodes. `four` is a FourNodes<true>. If n is not a multiple of
/// four, `four` is a FourNodes<> in the last call.
template <class F>
void for_each_four(Eigen::Index n, F&& act) {
  Eigen::Index first = 0;
  for (; first + Pack::kLanes <= n; first += Pack::kLanes) act(FourNodes<true>(first, n));
  if (first < n) act(FourNodes<>(first, n));
}

}  // namespace pliant
