// Which nodes the corners of elements are: elements in packs of four, one a lane, and for each node the
// corners that meet there, in the order of the elements. Elements write what they push into a buffer, three
// numbers a corner; then every node sums its own, so that neither threads nor their number change a bit.
#pragma once

#include <algorithm>
#include <cstring>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/math/pack.h>
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
  /// Packs and nodes that a thread takes at once.
  static constexpr int kPacks = 64, kNodes = 512;
  std::size_t buffer_size() const { return nodes_.size() * 3; }

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
  /// Writes what the corners of a pack push into the buffer.
  static void put(const Vec3<Pack>* pushes, int pack, double* buffer) {
    std::memcpy(buffer + static_cast<std::ptrdiff_t>(pack) * N * 3 * Pack::kLanes, pushes,
                N * sizeof(Vec3<Pack>));
  }
  /// f -= sums over the corners of each node.
  void subtract_sums(const double* buffer, double* f, ThreadPool* pool) const {
    for_ranges(pool, n_nodes_, kNodes, [&](int first, int last) {
      for (int i = first; i < last; ++i) {
        double sum[3]{};
        for (int k = first_[static_cast<std::size_t>(i)]; k < first_[static_cast<std::size_t>(i) + 1]; ++k) {
          const double* push = buffer + slots_[static_cast<std::size_t>(k)];
          for (int r = 0; r < 3; ++r) sum[r] += push[r * Pack::kLanes];
        }
        for (int r = 0; r < 3; ++r) f[r * static_cast<std::ptrdiff_t>(n_nodes_) + i] -= sum[r];
      }
    });
  }
  /// f(element) for every element that has the node.
  template <class F>
  void for_elements(int node, F&& f) const {
    for (int k = first_[static_cast<std::size_t>(node)]; k < first_[static_cast<std::size_t>(node) + 1];
         ++k) {
      const int slot = slots_[static_cast<std::size_t>(k)], lane = slot % Pack::kLanes;
      f(slot / (3 * N * Pack::kLanes) * Pack::kLanes + lane);
    }
  }

 private:
  int n_nodes_, n_elements_;
  std::vector<int> nodes_;          // pack, corner, lane; the last pack is filled up with its last element
  std::vector<int> first_, slots_;  // of node i: slots_[first_[i]] .. slots_[first_[i + 1] - 1]
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
  first_.assign(static_cast<std::size_t>(n_nodes) + 1, 0);
  for (int e = 0; e < n_elements_; ++e)
    for (int a = 0; a < N; ++a) ++first_[static_cast<std::size_t>(node(e, a)) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  slots_.resize(static_cast<std::size_t>(first_.back()));
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int e = 0; e < n_elements_; ++e)
    for (int a = 0; a < N; ++a)
      slots_[static_cast<std::size_t>(next[static_cast<std::size_t>(node(e, a))]++)] =
          (e / Pack::kLanes * N + a) * 3 * Pack::kLanes + e % Pack::kLanes;
}

}  // namespace pliant
