// Which nodes the corners of elements are, and sums over the corners that meet in a node. Elements come in
// packs of four, one a lane, and packs in blocks of a fixed size: a block sums what its elements push on each
// of its own nodes, in the order of the elements; then every node sums its blocks. Neither threads nor their
// number change a bit, and little passes through memory.
#pragma once

#include <algorithm>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/math/scalar/pack.h>
#include <pliant/math/thread_pool.h>

namespace pliant {

/// f(first, last) over ranges of at most `length` of 0 .. n - 1, by the threads of the pool (may be nullptr).
template <class F>
void for_ranges(ThreadPool* pool, int n, int length, F&& f) {
  auto task = [&](int range) { f(range * length, std::min(n, (range + 1) * length)); };
  const int ranges = (n + length - 1) / length;
  if (pool != nullptr)
    pool->run(ranges, std::ref(task));
  else
    for (int i = 0; i < ranges; ++i) task(i);
}

template <int N>
class ElementCorners {
 public:
  /// elements: N rows of nodes below n_nodes, else std::invalid_argument.
  ElementCorners(const Eigen::MatrixXi& elements, int n_nodes);

  int n_nodes() const { return n_nodes_; }
  int n_elements() const { return n_elements_; }
  int n_packs() const { return static_cast<int>(nodes_.size()) / (N * Pack::kLanes); }
  /// Numbers that sums of R components need room for.
  std::size_t buffer_size(int R = 3) const { return block_nodes_ * static_cast<std::size_t>(R); }
  /// Packs of a block, and nodes that a thread takes at once.
  static constexpr int kPacks = 128, kNodes = 512;

  int node(int element, int corner) const {
    return nodes_[static_cast<std::size_t>((element / Pack::kLanes * N + corner) * Pack::kLanes +
                                           element % Pack::kLanes)];
  }
  /// The vectors of the corners of a pack, from coordinates x of all nodes.
  void gather(const double* x, int pack, Vec3<Pack>* corners) const {
    const int* of = nodes_.data() + static_cast<std::ptrdiff_t>(pack) * N * Pack::kLanes;
    for (int a = 0; a < N; ++a, of += Pack::kLanes)
      for (int r = 0; r < 3; ++r) {
        const double* along = x + static_cast<std::ptrdiff_t>(r) * n_nodes_;
        double four[Pack::kLanes];
        for (int lane = 0; lane < Pack::kLanes; ++lane) four[lane] = along[of[lane]];
        std::memcpy(&corners[a][r], four, sizeof four);
      }
  }
  /// push(pack, pushes) gives R numbers for each corner of a pack, pushes[a][r]; take(node, sum) gets their
  /// sums. What lanes without an element push must be 0.
  template <int R, class Push, class Take>
  void sum(double* buffer, ThreadPool* pool, Push&& push, Take&& take) const {
    for_ranges(pool, n_packs(), kPacks, [&](int first, int last) {
      const auto block = static_cast<std::size_t>(first / kPacks);
      double* sums = buffer + R * block_first_[block];
      std::fill(sums, buffer + R * block_first_[block + 1], 0.0);
      for (int pack = first; pack < last; ++pack) {
        Pack pushes[N][R];
        push(pack, pushes);
        const int* to = local_.data() + static_cast<std::ptrdiff_t>(pack) * N * Pack::kLanes;
        for (int a = 0; a < N; ++a, to += Pack::kLanes)
          for (int r = 0; r < R; ++r) {
            double four[Pack::kLanes];
            std::memcpy(four, &pushes[a][r], sizeof four);
            for (int lane = 0; lane < Pack::kLanes; ++lane) sums[R * to[lane] + r] += four[lane];
          }
      }
    });
    for_ranges(pool, n_nodes_, kNodes, [&](int first, int last) {
      for (int i = first; i < last; ++i) {
        double total[R]{};
        for (int k = first_[static_cast<std::size_t>(i)]; k < first_[static_cast<std::size_t>(i) + 1]; ++k)
          for (int r = 0; r < R; ++r) total[r] += buffer[R * slots_[static_cast<std::size_t>(k)] + r];
        take(i, total);
      }
    });
  }
  /// f -= sums of vectors, f: coordinates of all nodes.
  template <class Push>
  void subtract_sums(double* buffer, double* f, ThreadPool* pool, Push&& push) const {
    sum<3>(buffer, pool, push, [&](int node, const double* total) {
      for (int r = 0; r < 3; ++r) f[r * static_cast<std::ptrdiff_t>(n_nodes_) + node] -= total[r];
    });
  }

 private:
  int n_nodes_, n_elements_;
  std::vector<int> nodes_, local_;  // pack, corner, lane: node, and its number in the block; the last pack
                                    // is filled up with its last element
  std::vector<std::size_t> block_first_;  // of a block's nodes among those of all blocks
  std::size_t block_nodes_ = 0;           // of all blocks
  std::vector<int> first_, slots_;        // of node i: slots_[first_[i]] .. slots_[first_[i + 1] - 1]
};

template <int N>
ElementCorners<N>::ElementCorners(const Eigen::MatrixXi& elements, int n_nodes)
    : n_nodes_(n_nodes), n_elements_(static_cast<int>(elements.cols())) {
  if (elements.rows() != N)
    throw std::invalid_argument("elements of " + std::to_string(N) + " nodes are needed, not of " +
                                std::to_string(elements.rows()));
  if (n_elements_ > 0 && (elements.minCoeff() < 0 || elements.maxCoeff() >= n_nodes))
    throw std::invalid_argument("an element names a node that is no node of the mesh");
  const int packs = (n_elements_ + Pack::kLanes - 1) / Pack::kLanes;
  for (int pack = 0; pack < packs; ++pack)
    for (int a = 0; a < N; ++a)
      for (int lane = 0; lane < Pack::kLanes; ++lane)
        nodes_.push_back(elements(a, std::min(pack * Pack::kLanes + lane, n_elements_ - 1)));
  std::vector<int> owner;  // node of each slot
  std::vector<int> seen(static_cast<std::size_t>(n_nodes),
                        -1);  // slot of a node in the last block that has it
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (i % (static_cast<std::size_t>(kPacks) * N * Pack::kLanes) == 0) block_first_.push_back(owner.size());
    int& slot = seen[static_cast<std::size_t>(nodes_[i])];
    if (slot < static_cast<int>(block_first_.back())) {
      slot = static_cast<int>(owner.size());
      owner.push_back(nodes_[i]);
    }
    local_.push_back(slot - static_cast<int>(block_first_.back()));
  }
  block_nodes_ = owner.size();
  block_first_.push_back(block_nodes_);
  first_.assign(static_cast<std::size_t>(n_nodes) + 1, 0);
  for (int node_of : owner) ++first_[static_cast<std::size_t>(node_of) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  slots_.resize(owner.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (std::size_t slot = 0; slot < owner.size(); ++slot)
    slots_[static_cast<std::size_t>(next[static_cast<std::size_t>(owner[slot])]++)] = static_cast<int>(slot);
}

}  // namespace pliant
