// Four nodes at a time: reads and writes them in columns of numbers, one a node, as Packs.
#pragma once

#include <algorithm>
#include <cstring>

#include <pliant/math/pack.h>
#include <pliant/math/types.h>

namespace pliant {

class FourNodes {
 public:
  FourNodes(Eigen::Index first, Eigen::Index n)
      : first_(first), count_(static_cast<int>(std::min<Eigen::Index>(Pack::kLanes, n - first))) {}

  Eigen::Index first() const { return first_; }
  /// Lanes beyond the last node are zero.
  Pack load(const double* column) const {
    Pack x;
    const double* from = column + first_;
    if (count_ == Pack::kLanes) {
      std::memcpy(x.vectors, from, sizeof x.vectors);
      return x;
    }
    for (int i = 0; i < Pack::kLanes; ++i) x.set(i, i < count_ ? from[i] : 0.0);
    return x;
  }
  void store(double* column, const Pack& x) const {
    double* to = column + first_;
    if (count_ == Pack::kLanes) {
      std::memcpy(to, x.vectors, sizeof x.vectors);
      return;
    }
    for (int i = 0; i < count_; ++i) to[i] = x[i];
  }
  /// The same of three columns that stand one after the other.
  Vec3<Pack> load(const double* columns, Eigen::Index rows) const {
    return {load(columns), load(columns + rows), load(columns + 2 * rows)};
  }
  void store(double* columns, Eigen::Index rows, const Vec3<Pack>& x) const {
    for (int r = 0; r < 3; ++r) store(columns + r * rows, x[r]);
  }

 private:
  Eigen::Index first_;
  int count_;
};

/// act(four) for all of n nodes.
template <class F>
void for_each_four(Eigen::Index n, F&& act) {
  for (Eigen::Index first = 0; first < n; first += Pack::kLanes) act(FourNodes(first, n));
}

}  // namespace pliant
