// L D L^T of a symmetric positive semi-definite matrix of small blocks, such as W_c = C_q M^-1 C_q^T. Rows
// that depend on those before them are found by their vanishing pivot and held: their unknown is 0, and all
// else is solved as if they were not there. S is double or Dual<1>.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <type_traits>
#include <vector>

#include <pliant/math/dual.h>
#include <pliant/math/index.h>
#include <pliant/math/types.h>
#include <pliant/solve/block_pattern.h>
#include <pliant/solve/symmetric_factor.h>

namespace pliant {

/// How rows that depend on others are told: by a vanished pivot; by the factor before, as where joints are a
/// little open within a step, which makes such rows seem independent; or only where nothing but rounding is
/// left of a pivot, next to a singular position.
enum class RankRule { decide, keep, rounding };

template <class S>
class BlockFactor {
 public:
  /// A pivot at or below this part of its diagonal entry has vanished, and one of which only rounding is
  /// left.
  static constexpr double kVanished = 1e-9, kRounding = 1e-12;

  /// All blocks zero. The pattern must outlive the factor.
  void clear(const BlockPattern& pattern, RankRule rule = RankRule::decide) {
    keep_ = rule == RankRule::keep && pattern_ == &pattern;
    vanished_ = rule == RankRule::rounding ? kRounding : kVanished;
    pattern_ = &pattern;
    values_.assign(static_cast<std::size_t>(pattern.values()), S(0.0));
    if (!keep_) held_.assign(static_cast<std::size_t>(pattern.rows()), 0);
    measures_.clear();
  }
  /// Pivots of a row, whose diagonal entry is what is left of larger ones, are measured by those.
  void measure_by(int row, double entry) { measures_.push_back({row, entry}); }
  /// Numbers of the block at an offset that the pattern gave, by columns.
  S* block(int offset) { return values_.data() + offset; }

  /// Factors the blocks that were filled in since clear().
  void factor() {
    smallest_ = 1;
    const auto& columns = pattern_->columns();
    diagonal_.resize(static_cast<std::size_t>(pattern_->rows()));
    inverse_.resize(static_cast<std::size_t>(pattern_->rows()));
    for (const BlockPattern::Column& c : columns)
      for (int k = 0; k < c.size; ++k)
        diagonal_[static_cast<std::size_t>(c.row + k)] = plain(values_[at(c.diagonal + k * (c.size + 1))]);
    for (const Measure& m : measures_) diagonal_[at(m.row)] = std::max(diagonal_[at(m.row)], m.entry);
    for (const BlockPattern::Column& c : columns) eliminate(c);
  }

  /// x = A^-1 x, with zeros for held rows. x is in the order of the nodes.
  void solve(VecX<S>& x) const {
    const auto& columns = pattern_->columns();
    for (const BlockPattern::Column& c : columns)
      sized(c.size, [&](auto n) {
        S* y = x.data() + c.row;
        const S* D = values_.data() + c.diagonal;
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
        for (int k = 0; k < n; ++k) y[k] = y[k] * inverse_[at(c.row + k)];
      });
    for (auto c = columns.rbegin(); c != columns.rend(); ++c)
      sized(c->size, [&](auto n) {
        S* y = x.data() + c->row;
        for (int b = c->first; b < c->last; ++b) {
          const BlockPattern::Block& block = pattern_->blocks()[at(b)];
          const BlockPattern::Column& below = columns[at(block.place)];
          const S* L = values_.data() + block.offset;
          const S* z = x.data() + below.row;
          sized(below.size, [&](auto rows) {
            for (int k = 0; k < n; ++k)
              for (int i = 0; i < rows; ++i) y[k] -= L[k * rows + i] * z[i];
          });
        }
        const S* D = values_.data() + c->diagonal;
        for (int k = n - 1; k >= 0; --k)
          for (int i = k + 1; i < n; ++i) y[k] -= D[k * n + i] * y[i];
      });
  }

  /// Whether a row, in the order of the nodes, depends on others.
  bool held(int row) const { return held_[at(row)] != 0; }
  int rank() const {
    int rank = pattern_->rows();
    for (const std::uint8_t held : held_) rank -= held;
    return rank;
  }
  /// The smallest pivot that counts, as part of its diagonal entry: digits that the elimination cost.
  double smallest_pivot() const { return smallest_; }

 private:
  struct Measure {
    int row;
    double entry;
  };

  /// act(n), with the three rows of a ball joint as a constant, so that loops unroll.
  template <class F>
  static void sized(int n, F&& act) {
    if (n == 3)
      act(std::integral_constant<int, 3>());
    else
      act(n);
  }

  void eliminate(const BlockPattern::Column& c) {
    const auto& columns = pattern_->columns();
    const auto& blocks = pattern_->blocks();
    sized(c.size, [&](auto n) {
      eliminate_diagonal(c, n);
      // X = L D of the blocks below, while L itself replaces them.
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

  S* scaled(int b) { return scaled_.data() + b * kMaxBlock * kMaxBlock; }

  /// The diagonal block into its L and D, in place. Held rows have no inverse pivot and a zero column, so
  /// that they take no part in what follows.
  template <class Size>
  void eliminate_diagonal(const BlockPattern::Column& c, Size n) {
    S* A = values_.data() + c.diagonal;
    for (int j = 0; j < n; ++j) {
      S d = A[j * n + j];
      for (int k = 0; k < j; ++k) d -= A[k * n + j] * A[k * n + j] * A[k * n + k];
      const double from = diagonal_[at(c.row + j)], left = plain(d);
      // What is not a number is left to the finite check.
      const bool gone = (keep_ && held(c.row + j)) ||
                        (std::isfinite(from) && !(left > (keep_ ? kRounding : vanished_) * from));
      if (gone) {
        held_[at(c.row + j)] = 1;
        inverse_[at(c.row + j)] = S(0.0);
        A[j * n + j] = S(1.0);
        for (int i = j + 1; i < n; ++i) A[j * n + i] = S(0.0);
        continue;
      }
      smallest_ = left < smallest_ * from ? left / from : smallest_;
      const S inverse = S(1.0) / d;
      inverse_[at(c.row + j)] = inverse;
      A[j * n + j] = d;
      for (int i = j + 1; i < n; ++i) {
        S sum = A[j * n + i];
        for (int k = 0; k < j; ++k) sum -= A[k * n + i] * A[k * n + j] * A[k * n + k];
        A[j * n + i] = sum * inverse;
      }
    }
  }

  /// A block B below: X from X L^T = B, then B = X D^-1, with zero columns for held rows.
  template <class Size, class Rows>
  void divide(const BlockPattern::Column& c, Size n, int offset, Rows rows, S* X) {
    S* B = values_.data() + offset;
    const S* A = values_.data() + c.diagonal;
    for (int k = 0; k < n; ++k) {
      S* x = X + k * rows;
      for (int i = 0; i < rows; ++i) x[i] = B[k * rows + i];
      for (int m = 0; m < k; ++m)
        for (int i = 0; i < rows; ++i) x[i] -= X[m * rows + i] * A[m * n + k];
      if (held_[at(c.row + k)] != 0)
        for (int i = 0; i < rows; ++i) x[i] = S(0.0);
      const S inverse = inverse_[at(c.row + k)];
      for (int i = 0; i < rows; ++i) B[k * rows + i] = x[i] * inverse;
    }
  }

  /// C -= X L^T.
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
  std::vector<S> inverse_;  ///< 1 / pivot of each row; 0 of held ones
  std::vector<double> diagonal_;
  std::vector<Measure> measures_;
  std::vector<std::uint8_t> held_;
  double smallest_ = 1, vanished_ = kVanished;
  bool keep_ = false;
};

}  // namespace pliant
