// Elements with K corners, in batches of four: one element in each lane of a Pack. Each element writes the
// forces at its corners to its own section of a buffer. Then the forces of each node are summed in the order
// of the elements, so that the sums do not depend on the number of threads. The order of the buffer is
// [batch][corner][x, y, z][lane]. Free lanes of the last batch repeat the last element; their numbers in the
// buffer are not used.
#pragma once

#include <array>
#include <cstring>
#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/local/ranges.h>
#include <pliant/math/scalar/pack.h>

namespace pliant {

/// Reads four numbers from memory.
inline Pack load(const double* from) {
  Pack p;
  std::memcpy(&p, from, sizeof p);
  return p;
}
/// Writes the four lanes to memory.
inline void store(const Pack& p, double* to) {
  std::memcpy(to, &p, sizeof p);
}

template <int K>
class ElementBatches {
 public:
  using Elements = Eigen::Matrix<int, K, Eigen::Dynamic>;
  using Corners = std::array<Vec3<Pack>, K>;

  /// elements: node numbers below n_nodes, one column for each element. The numbers are not checked.
  ElementBatches(const Elements& elements, Eigen::Index n_nodes);

  int n_elements() const { return n_elements_; }
  int n_nodes() const { return n_nodes_; }
  int n_batches() const { return static_cast<int>(nodes_.size()); }
  /// Returns the element in a lane of a batch; in free lanes, the last element.
  int element(int batch, int lane) const { return std::min(Pack::kLanes * batch + lane, n_elements_ - 1); }
  /// Returns the number of used lanes of a batch.
  int lanes(int batch) const { return std::min(Pack::kLanes, n_elements_ - Pack::kLanes * batch); }
  int node(int batch, int corner, int lane) const {
    return nodes_[static_cast<std::size_t>(batch)][static_cast<std::size_t>(corner)]
                 [static_cast<std::size_t>(lane)];
  }
  /// Returns the indices of an element's local coordinates: x, y, z of its first corner, then of the second,
  /// ...
  std::array<int, 3 * K> coordinates(int batch, int lane) const {
    std::array<int, 3 * K> index;
    for (int k = 0; k < K; ++k)
      for (int i = 0; i < 3; ++i)
        index[static_cast<std::size_t>(3 * k + i)] = node(batch, k, lane) + i * n_nodes_;
    return index;
  }
  /// Returns the length of the buffer of add().
  std::size_t buffer_size() const { return nodes_.size() * static_cast<std::size_t>(kBatchSize); }

  /// Reads the vectors at the corners of a batch from local coordinates (nodes.h).
  Corners corners(const Coordinates& x, int batch) const {
    Corners c;
    const auto& at = nodes_[static_cast<std::size_t>(batch)];
    for (std::size_t k = 0; k < K; ++k)
      for (int i = 0; i < 3; ++i) {
        const double* from = x.data() + i * static_cast<std::ptrdiff_t>(n_nodes_);
        c[k][i] = Pack(from[at[k][0]], from[at[k][1]], from[at[k][2]], from[at[k][3]]);
      }
    return c;
  }

  /// Adds the nodal forces of all batches to f. forces(batch) returns the forces at the corners of a batch.
  /// buffer: scratch storage of buffer_size() numbers.
  template <class Forces>
  void add(VecX<double>& f, double* buffer, ThreadPool* pool, Forces&& forces) const {
    for_ranges(
        n_batches(), kBatchesInRange, pool, [&](int first, int last) __attribute__((flatten)) {
          for (int b = first; b < last; ++b) {
            const Corners force = forces(b);
            double* to = buffer + b * kBatchSize;
            for (std::size_t k = 0; k < K; ++k)
              for (int i = 0; i < 3; ++i, to += Pack::kLanes) store(force[k][i], to);
          }
        });
    add_corners(f, buffer, pool);
  }

 private:
  static constexpr std::ptrdiff_t kBatchSize = std::ptrdiff_t{3} * K * Pack::kLanes;
  static constexpr int kBatchesInRange = 512, kNodesInRange = 2048;

  /// Adds the corner forces in the buffer to the nodes.
  void add_corners(VecX<double>& f, const double* buffer, ThreadPool* pool) const;

  int n_elements_, n_nodes_;
  std::vector<std::array<std::array<int, Pack::kLanes>, K>> nodes_;
  // The corners at node i have their x components at the buffer indices buffer_index_[first_[i]] ..
  // buffer_index_[first_[i + 1] - 1].
  std::vector<int> first_, buffer_index_;
};

template <int K>
ElementBatches<K>::ElementBatches(const Elements& elements, Eigen::Index n_nodes)
    : n_elements_(static_cast<int>(elements.cols())),
      n_nodes_(static_cast<int>(n_nodes)),
      nodes_(static_cast<std::size_t>((elements.cols() + Pack::kLanes - 1) / Pack::kLanes)),
      first_(static_cast<std::size_t>(n_nodes) + 1, 0),
      buffer_index_(static_cast<std::size_t>(K * elements.cols())) {
  for (int b = 0; b < n_batches(); ++b)
    for (int lane = 0; lane < Pack::kLanes; ++lane)
      for (int k = 0; k < K; ++k)
        nodes_[static_cast<std::size_t>(b)][static_cast<std::size_t>(k)][static_cast<std::size_t>(lane)] =
            elements(k, element(b, lane));
  for (int e = 0; e < n_elements_; ++e)
    for (int k = 0; k < K; ++k) ++first_[static_cast<std::size_t>(elements(k, e)) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (int e = 0; e < n_elements_; ++e)
    for (int k = 0; k < K; ++k)
      buffer_index_[static_cast<std::size_t>(next[static_cast<std::size_t>(elements(k, e))]++)] =
          ((e / Pack::kLanes) * K + k) * 3 * Pack::kLanes + e % Pack::kLanes;
}

template <int K>
void ElementBatches<K>::add_corners(VecX<double>& f, const double* buffer, ThreadPool* pool) const {
  for_ranges(n_nodes_, kNodesInRange, pool, [&](int first, int last) {
    double* out = f.data();
    const std::ptrdiff_t n = n_nodes_;
    for (int i = first; i < last; ++i) {
      double sum[3] = {0, 0, 0};
      for (int p = first_[static_cast<std::size_t>(i)]; p < first_[static_cast<std::size_t>(i) + 1]; ++p) {
        const double* from = buffer + buffer_index_[static_cast<std::size_t>(p)];
        for (int c = 0; c < 3; ++c) sum[c] += from[static_cast<std::ptrdiff_t>(c) * Pack::kLanes];
      }
      for (int c = 0; c < 3; ++c) out[c * n + i] += sum[c];
    }
  });
}

}  // namespace pliant
