// Node numbers of elements with N nodes, and parallel sums over the corners that share a node. Elements are
// stored in packs of four, one element in each lane, and packs in blocks of fixed size. Each block sums the
// terms of its elements at each of its nodes, in the order of the elements. Then the sums of all blocks are
// added at each node. The order of every sum is fixed, so that results do not depend on the number of
// threads. The blocks keep the buffer small.
#pragma once

#include <algorithm>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/local/ranges.h>
#include <pliant/math/scalar/pack.h>
#include <pliant/math/thread_pool.h>

namespace pliant {

template <int N>
class ElementCorners {
 public:
  /// elements: N node numbers in each column, all below n_nodes. Throws std::invalid_argument otherwise.
  ElementCorners(const Eigen::MatrixXi& elements, int n_nodes);

  int n_nodes() const { return n_nodes_; }
  int n_elements() const { return n_elements_; }
  int n_packs() const { return static_cast<int>(nodes_.size()) / (N * Pack::kLanes); }
  /// Returns the length of the buffer of sum<R>.
  std::size_t buffer_size(int R = 3) const { return block_nodes_ * static_cast<std::size_t>(R); }
  /// kPacks: number of packs in a block; kNodes: number of nodes that one task of the thread pool sums.
  static constexpr int kPacks = 128, kNodes = 512;

  int node(int element, int corner) const {
    return nodes_[static_cast<std::size_t>((element / Pack::kLanes * N + corner) * Pack::kLanes +
                                           element % Pack::kLanes)];
  }
  /// Reads the nodal vectors of a pack's corners from coordinates x of all nodes (nodes.h).
  void gather(const double* x, int pack, Vec3<Pack>* corners) const {
    const int* node = nodes_.data() + static_cast<std::ptrdiff_t>(pack) * N * Pack::kLanes;
    for (int a = 0; a < N; ++a, node += Pack::kLanes)
      for (int r = 0; r < 3; ++r) {
        const double* component = x + static_cast<std::ptrdiff_t>(r) * n_nodes_;
        double four[Pack::kLanes];
        for (int lane = 0; lane < Pack::kLanes; ++lane) four[lane] = component[node[lane]];
        std::memcpy(&corners[a][r], four, sizeof four);
      }
  }
  /// Sums R numbers over the corners of each node. terms(pack, t) computes the terms t[a][r] of the corners
  /// of a pack, 0 in lanes without an element. use(node, sums) receives the R sums of each node. buffer:
  /// scratch storage of buffer_size(R) numbers.
  template <int R, class Terms, class Use>
  void sum(double* buffer, ThreadPool* pool, Terms&& terms, Use&& use) const {
    for_blocks(n_packs(), kPacks, pool, [&](int first, int last) {
      const auto block = static_cast<std::size_t>(first / kPacks);
      double* sums = buffer + R * block_first_[block];
      std::fill(sums, buffer + R * block_first_[block + 1], 0.0);
      for (int pack = first; pack < last; ++pack) {
        Pack t[N][R];
        terms(pack, t);
        const int* slot = local_.data() + static_cast<std::ptrdiff_t>(pack) * N * Pack::kLanes;
        for (int a = 0; a < N; ++a, slot += Pack::kLanes)
          for (int r = 0; r < R; ++r) {
            double four[Pack::kLanes];
            std::memcpy(four, &t[a][r], sizeof four);
            for (int lane = 0; lane < Pack::kLanes; ++lane) sums[R * slot[lane] + r] += four[lane];
          }
      }
    });
    for_blocks(n_nodes_, kNodes, pool, [&](int first, int last) {
      for (int i = first; i < last; ++i) {
        double total[R]{};
        for (int k = first_[static_cast<std::size_t>(i)]; k < first_[static_cast<std::size_t>(i) + 1]; ++k)
          for (int r = 0; r < R; ++r) total[r] += buffer[R * slots_[static_cast<std::size_t>(k)] + r];
        use(i, total);
      }
    });
  }
  /// Subtracts the sums of the vectors t[a][0..2] of all corners from the vectors f of all nodes (order of
  /// nodes.h). buffer, terms: as in sum<3>.
  template <class Terms>
  void subtract_sums(double* buffer, double* f, ThreadPool* pool, Terms&& terms) const {
    sum<3>(buffer, pool, terms, [&](int node, const double* total) {
      for (int r = 0; r < 3; ++r) f[r * static_cast<std::ptrdiff_t>(n_nodes_) + node] -= total[r];
    });
  }

 private:
  int n_nodes_, n_elements_;
  // Indexed by [pack][corner][lane]: the node, and the number of the node among the nodes of its block. Free
  // lanes of the last pack repeat the last element.
  std::vector<int> nodes_, local_;
  // A slot is one node of one block. Slots of block b: block_first_[b] .. block_first_[b + 1] - 1.
  std::vector<std::size_t> block_first_;
  std::size_t block_nodes_ = 0;     // number of slots
  std::vector<int> first_, slots_;  // slots of node i: slots_[first_[i]] .. slots_[first_[i + 1] - 1]
};

template <int N>
ElementCorners<N>::ElementCorners(const Eigen::MatrixXi& elements, int n_nodes)
    : n_nodes_(n_nodes), n_elements_(static_cast<int>(elements.cols())) {
  if (elements.rows() != N)
    throw std::invalid_argument("elements have " + std::to_string(elements.rows()) +
                                " nodes; this energy needs elements with " + std::to_string(N) + " nodes");
  if (n_elements_ > 0 && (elements.minCoeff() < 0 || elements.maxCoeff() >= n_nodes))
    throw std::invalid_argument("elements refer to nodes " + std::to_string(elements.minCoeff()) + " to " +
                                std::to_string(elements.maxCoeff()) + "; the mesh has nodes 0 to " +
                                std::to_string(n_nodes - 1));
  const int packs = (n_elements_ + Pack::kLanes - 1) / Pack::kLanes;
  for (int pack = 0; pack < packs; ++pack)
    for (int a = 0; a < N; ++a)
      for (int lane = 0; lane < Pack::kLanes; ++lane)
        nodes_.push_back(elements(a, std::min(pack * Pack::kLanes + lane, n_elements_ - 1)));
  std::vector<int> owner;                                        // node of each slot
  std::vector<int> seen(static_cast<std::size_t>(n_nodes), -1);  // last slot of each node so far
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
  for (int node_of_slot : owner) ++first_[static_cast<std::size_t>(node_of_slot) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  slots_.resize(owner.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (std::size_t slot = 0; slot < owner.size(); ++slot)
    slots_[static_cast<std::size_t>(next[static_cast<std::size_t>(owner[slot])]++)] = static_cast<int>(slot);
}

}  // namespace pliant
