// Four nodes at a time: reads and writes them in columns of numbers, one a node, as Packs.
#pragma once

#include <algorithm>
#include <cstring>

#include <pliant/math/scalar/pack.h>
#include <pliant/math/types.h>

namespace pliant {

/// whole: known to have four, so that sums over nodes stay in registers.
template <bool whole = false>
class FourNodes {
 public:
  FourNodes(Eigen::Index first, Eigen::Index n)
      : first_(first), count_(static_cast<int>(std::min<Eigen::Index>(Pack::kLanes, n - first))) {}

  Eigen::Index first() const { return first_; }
  /// Lanes beyond the last node are zero.
  [[gnu::always_inline]] Pack load(const double* column) const {
    if constexpr (!whole)
      if (count_ != Pack::kLanes) return load_some(column + first_);
    Pack x;
    std::memcpy(x.vectors, column + first_, sizeof x.vectors);
    return x;
  }
  [[gnu::always_inline]] void store(double* column, const Pack& x) const {
    if constexpr (!whole)
      if (count_ != Pack::kLanes) return store_some(column + first_, x);
    std::memcpy(column + first_, x.vectors, sizeof x.vectors);
  }
  /// The same of three columns that stand one after the other.
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

/// act(four) for all of n nodes; four is of one or the other type.
template <class F>
void for_each_four(Eigen::Index n, F&& act) {
  Eigen::Index first = 0;
  for (; first + Pack::kLanes <= n; first += Pack::kLanes) act(FourNodes<true>(first, n));
  if (first < n) act(FourNodes<>(first, n));
}

}  // namespace pliant
