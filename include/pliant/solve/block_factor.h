// Factorisation L D L^T of a symmetric positive semi-definite matrix of small blocks, for example of the
// joint system W_c = C_q M^-1 C_q^T. The elimination works on blocks while the matrix is sparse. It works on
// one dense matrix when no remaining block is zero and at least kFewDense rows remain. Rows that depend on
// earlier rows are excluded (pivots.h). Rows with small pivots are exchanged with later rows of their node,
// or of the dense matrix. S is double or Dual<1>.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/math/index.h>
#include <pliant/math/types.h>
#include <pliant/solve/block_pattern.h>
#include <pliant/solve/dense_factor.h>
#include <pliant/solve/pivots.h>

namespace pliant {

/// A block matrix; after factor() its factor.
template <class S>
class BlockFactor {
 public:
  /// Sets all blocks to zero. The pattern must exist until the last use of the factor, or until the next
  /// clear(). RankRule::keep has an effect only if `pattern` is the object of the previous call; otherwise
  /// RankRule::decide applies.
  void clear(const BlockPattern& pattern, RankRule rule = RankRule::decide) {
    const bool changed = pattern_ != &pattern;
    pattern_ = &pattern;
    values_.assign(at(pattern.values()), S(0.0));
    pivots_.clear(pattern.rows(), changed && rule == RankRule::keep ? RankRule::decide : rule);
    order_.resize(at(pattern.rows()));
    exchanged_.assign(at(pattern.nodes()), 0);
  }
  /// Sets a lower bound of the scale for the pivot of a row (see Pivots::raise_scale).
  void raise_scale(int row, double entry) { pivots_.raise_scale(row, entry); }
  /// Returns the entries of a block, by columns. offset: from BlockPattern::place.
  S* block(int offset) { return values_.data() + offset; }

  /// Factors the matrix whose blocks were written since clear().
  void factor() {
    for (const BlockPattern::Column& c : pattern_->columns())
      for (int k = 0; k < c.size; ++k)
        pivots_.set_entry(c.row + k, values_[at(c.diagonal + k * (c.size + 1))]);
    pivots_.apply_measures();
    for (int place = 0; place < pattern_->first_dense(); ++place) eliminate(place);
    if (pattern_->dense_rows().empty()) return;
    gather_dense();
    dense_.factor(pattern_->dense_rows(), pivots_);
  }

  /// Computes x = A^-1 x, with zeros for excluded rows. x is in the order of the nodes. Not thread-safe:
  /// solve() uses a workspace of the object.
  void solve(VecX<S>& x) const {
    const auto& columns = pattern_->columns();
    for (int place = 0; place < pattern_->first_dense(); ++place) {
      const BlockPattern::Column& c = columns[at(place)];
      sized(c.size, [&](auto n) {
        S* y = x.data() + c.row;
        const S* D = values_.data() + c.diagonal;
        if (exchanged_[at(place)]) to_factor(c, y);
        for (int k = 0; k < n; ++k)
          for (int i = k + 1; i < n; ++i) y[i] -= D[k * n + i] * y[k];
        for (int b = c.first; b < c.last; ++b) {
          const BlockPattern::Block& block = pattern_->blocks()[at(b)];
          const BlockPattern::Column& below = columns[at(block.place)];
          const S* L = values_.data() + block.offset;
          S* z = x.data() + below.row;
          sized(below.size, [&](auto rows) {
            for (int k = 0; k < n; ++k)
              for (int i = 0; i < rows; ++i) z[i] -= L[k * rows + i] * y[k];
          });
        }
        if (exchanged_[at(place)]) from_factor(c, y);
        for (int k = 0; k < n; ++k) y[k] = y[k] * pivots_.inverse(c.row + k);
      });
    }
    if (!pattern_->dense_rows().empty()) solve_dense(x);
    for (int place = pattern_->first_dense(); place-- > 0;) {
      const BlockPattern::Column& c = columns[at(place)];
      sized(c.size, [&](auto n) {
        S* y = x.data() + c.row;
        if (exchanged_[at(place)]) to_factor(c, y);
        for (int b = c.first; b < c.last; ++b) {
          const BlockPattern::Block& block = pattern_->blocks()[at(b)];
          const BlockPattern::Column& below = columns[at(block.place)];
          const S* L = values_.data() + block.offset;
          const S* z = x.data() + below.row;
          sized(below.size, [&](auto rows) {
            for (int k = 0; k < n; ++k)
              for (int i = 0; i < rows; ++i) y[k] -= L[k * rows + i] * z[i];
          });
        }
        const S* D = values_.data() + c.diagonal;
        for (int k = n - 1; k >= 0; --k)
          for (int i = k + 1; i < n; ++i) y[k] -= D[k * n + i] * y[i];
        if (exchanged_[at(place)]) from_factor(c, y);
      });
    }
  }

  /// Returns whether a row, in the order of the nodes, depends on other rows and is excluded.
  bool excluded(int row) const { return pivots_.excluded(row); }
  /// Returns the number of rows that are not excluded.
  int rank() const { return pivots_.rank(); }
  /// Returns the smallest ratio of an accepted pivot to its scale (see Pivots::smallest).
  double smallest_pivot() const { return pivots_.smallest(); }

 private:
  /// Calls act(n). For n = 3, the rows of a ball joint, n is a compile-time constant, so that loops unroll.
  template <class F>
  static void sized(int n, F&& act) {
    if (n == 3)
      act(std::integral_constant<int, 3>());
    else
      act(n);
  }

  /// Permutes the entries of a node from the order of its rows to the order of the factor.
  void to_factor(const BlockPattern::Column& c, S* y) const {
    std::array<S, kMaxBlock> rows;
    std::copy_n(y, c.size, rows.begin());
    for (int k = 0; k < c.size; ++k) y[k] = rows[at(order_[at(c.row + k)])];
  }
  /// Permutes the entries of a node from the order of the factor to the order of its rows.
  void from_factor(const BlockPattern::Column& c, S* y) const {
    std::array<S, kMaxBlock> factored;
    std::copy_n(y, c.size, factored.begin());
    for (int k = 0; k < c.size; ++k) y[order_[at(c.row + k)]] = factored[at(k)];
  }
  /// Returns the index in the vectors of the row that is eliminated as the k-th row of a node.
  int row_at(const BlockPattern::Column& c, int k) const { return c.row + order_[at(c.row + k)]; }

  /// Eliminates one column of blocks and updates the blocks to its right.
  void eliminate(int place) {
    const auto& columns = pattern_->columns();
    const auto& blocks = pattern_->blocks();
    const BlockPattern::Column& c = columns[at(place)];
    sized(c.size, [&](auto n) {
      if (eliminate_diagonal(c, n)) exchanged_[at(place)] = 1;
      // X = L D of the blocks below the diagonal; L overwrites these blocks.
      scaled_.resize(at(c.last - c.first) * kMaxBlock * kMaxBlock);
      for (int b = c.first; b < c.last; ++b)
        sized(columns[at(blocks[at(b)].place)].size,
              [&](auto rows) { divide(c, n, blocks[at(b)].offset, rows, scaled(b - c.first)); });
      int update = c.first_update;
      for (int b = c.first; b < c.last; ++b) {
        const S* L = values_.data() + blocks[at(b)].offset;
        for (int a = b; a < c.last; ++a, ++update)
          sized(columns[at(blocks[at(a)].place)].size, [&](auto rows_a) {
            sized(columns[at(blocks[at(b)].place)].size, [&](auto rows_b) {
              subtract_product(scaled(a - c.first), rows_a, L, rows_b, n,
                               values_.data() + pattern_->updates()[at(update)]);
            });
          });
      }
    });
  }

  /// Copies the remaining blocks into the lower triangle of the dense matrix.
  void gather_dense() {
    const auto n = static_cast<int>(pattern_->dense_rows().size());
    const auto& columns = pattern_->columns();
    dense_.matrix().resize(n, n);
    for (int place = pattern_->first_dense(), column = 0; place < pattern_->nodes(); ++place) {
      const BlockPattern::Column& c = columns[at(place)];
      int row = column;
      auto copy = [&](int offset, int rows) {
        for (int k = 0; k < c.size; ++k)
          std::copy_n(values_.data() + offset + k * rows, rows, &dense_.matrix()(row, column + k));
        row += rows;
      };
      copy(c.diagonal, c.size);
      for (int b = c.first; b < c.last; ++b) {
        const BlockPattern::Block& block = pattern_->blocks()[at(b)];
        copy(block.offset, columns[at(block.place)].size);
      }
      column += c.size;
    }
  }

  void solve_dense(VecX<S>& x) const {
    const std::vector<int>& rows = dense_.rows();
    dense_x_.resize(static_cast<Eigen::Index>(rows.size()));
    for (std::size_t i = 0; i < rows.size(); ++i) dense_x_.data()[i] = x[rows[i]];
    dense_.solve(pivots_, dense_x_);
    for (std::size_t i = 0; i < rows.size(); ++i) x[rows[i]] = dense_x_.data()[i];
  }

  S* scaled(int b) { return scaled_.data() + b * kMaxBlock * kMaxBlock; }

  /// Factors the diagonal block into L and D in place. An excluded row has a zero inverse pivot and a zero
  /// column, so that it has no effect on later rows. Sets the order of the rows; returns whether rows were
  /// exchanged.
  template <class Size>
  bool eliminate_diagonal(const BlockPattern::Column& c, Size n) {
    S* A = values_.data() + c.diagonal;
    bool exchanged = false;
    for (int j = 0; j < n; ++j) order_[at(c.row + j)] = j;
    for (int j = 0; j < n; ++j) {
      S d = pivot(A, n, j, j);
      if (pivots_.small(row_at(c, j), d)) {
        const int best = largest_pivot(c, n, j);
        if (best != j) {
          exchange(A, n, j, best);
          std::swap(order_[at(c.row + j)], order_[at(c.row + best)]);
          d = pivot(A, n, j, j);
          exchanged = true;
        }
      }
      if (!pivots_.accept(row_at(c, j), d)) {
        A[j * n + j] = S(1.0);
        for (int i = j + 1; i < n; ++i) A[j * n + i] = S(0.0);
        continue;
      }
      A[j * n + j] = d;
      for (int i = j + 1; i < n; ++i) {
        S sum = A[j * n + i];
        for (int k = 0; k < j; ++k) sum -= A[k * n + i] * A[k * n + j] * A[k * n + k];
        A[j * n + i] = sum * pivots_.inverse(row_at(c, j));
      }
    }
    return exchanged;
  }

  /// Returns the pivot of row i of a diagonal block A if the rows before j are eliminated.
  template <class Size>
  static S pivot(const S* A, Size n, int i, int j) {
    S d = A[i * n + i];
    for (int k = 0; k < j; ++k) d -= A[k * n + i] * A[k * n + i] * A[k * n + k];
    return d;
  }
  /// Returns the row i >= j of a diagonal block whose pivot has the largest ratio to its scale.
  template <class Size>
  int largest_pivot(const BlockPattern::Column& c, Size n, int j) const {
    const S* A = values_.data() + c.diagonal;
    int best = j;
    double largest = pivots_.ratio(row_at(c, j), pivot(A, n, j, j));
    for (int i = j + 1; i < n; ++i) {
      const double ratio = pivots_.ratio(row_at(c, i), pivot(A, n, i, j));
      if (ratio > largest) largest = ratio, best = i;
    }
    return best;
  }
  /// Exchanges the rows and columns j and p > j of a diagonal block whose columns before j are factored.
  template <class Size>
  static void exchange(S* A, Size n, int j, int p) {
    for (int k = 0; k < j; ++k) std::swap(A[k * n + j], A[k * n + p]);
    for (int i = j + 1; i < p; ++i) std::swap(A[j * n + i], A[i * n + p]);
    for (int i = p + 1; i < n; ++i) std::swap(A[j * n + i], A[p * n + i]);
    std::swap(A[j * n + j], A[p * n + p]);
  }

  /// Divides a block B below the diagonal: solves X L^T = B, then B = X D^-1, with zero columns for excluded
  /// rows. The columns of X and of the new B are in the order of the factor.
  template <class Size, class Rows>
  void divide(const BlockPattern::Column& c, Size n, int offset, Rows rows, S* X) {
    S* B = values_.data() + offset;
    const S* A = values_.data() + c.diagonal;
    for (int k = 0; k < n; ++k) std::copy_n(B + order_[at(c.row + k)] * rows, rows, X + k * rows);
    for (int k = 0; k < n; ++k) {
      S* x = X + k * rows;
      for (int m = 0; m < k; ++m)
        for (int i = 0; i < rows; ++i) x[i] -= X[m * rows + i] * A[m * n + k];
      if (pivots_.excluded(row_at(c, k)))
        for (int i = 0; i < rows; ++i) x[i] = S(0.0);
      const S inverse = pivots_.inverse(row_at(c, k));
      for (int i = 0; i < rows; ++i) B[k * rows + i] = x[i] * inverse;
    }
  }

  /// Computes C -= X L^T.
  template <class RowsX, class RowsL, class Size>
  static void subtract_product(const S* X, RowsX rows_x, const S* L, RowsL rows_l, Size n, S* C) {
    for (int j = 0; j < rows_l; ++j)
      for (int i = 0; i < rows_x; ++i) {
        S sum = X[i] * L[j];
        for (int k = 1; k < n; ++k) sum += X[k * rows_x + i] * L[k * rows_l + j];
        C[j * rows_x + i] -= sum;
      }
  }

  const BlockPattern* pattern_ = nullptr;
  std::vector<S> values_, scaled_;
  Pivots<S> pivots_;
  std::vector<int> order_;               ///< for each row of the factor, its row in the node
  std::vector<std::uint8_t> exchanged_;  ///< for each place, whether the rows of the node were exchanged
  DenseFactor<S> dense_;
  mutable VecX<S> dense_x_;  ///< workspace of solve()
};

}  // namespace pliant
