// L D L^T of a symmetric positive semi-definite matrix of small blocks, such as W_c = C_q M^-1 C_q^T. Rows
// that depend on those before them are found by their vanishing pivot and held: their unknown is 0, and all
// else is solved as if they were not there. S is double or Dual<1>.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <pliant/math/dual.h>
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
  }
  /// Numbers of the block at an offset that the pattern gave, by columns.
  S* block(int offset) { return values_.data() + offset; }

  /// Factors the blocks that were filled in since clear().
  void factor() {
    smallest_ = 1;
    const auto& columns = pattern_->columns();
    diagonal_.resize(static_cast<std::size_t>(pattern_->rows()));
    for (const BlockPattern::Column& c : columns)
      for (int k = 0; k < c.size; ++k)
        diagonal_[static_cast<std::size_t>(c.row + k)] = plain(values_[at(c.diagonal + k * (c.size + 1))]);
    for (const BlockPattern::Column& c : columns) eliminate(c);
  }

  /// x = A^-1 x, with zeros for held rows. x is in the order of the nodes.
  void solve(VecX<S>& x) const {
    const auto& columns = pattern_->columns();
    for (const BlockPattern::Column& c : columns) {
      const S* D = values_.data() + c.diagonal;
      for (int i = 0; i < c.size; ++i) {
        for (int k = 0; k < i; ++k) x[c.row + i] -= D[k * c.size + i] * x[c.row + k];
        if (held_[at(c.row + i)] != 0) x[c.row + i] = S(0.0);
      }
      for (int b = c.first; b < c.last; ++b) {
        const BlockPattern::Block& block = pattern_->blocks()[at(b)];
        const BlockPattern::Column& below = columns[at(block.place)];
        const S* L = values_.data() + block.offset;
        if (c.size == 3 && below.size == 3) {
          x.template segment<3>(below.row) -=
              Eigen::Map<const Mat3<S>>(L).lazyProduct(x.template segment<3>(c.row));
          continue;
        }
        for (int k = 0; k < c.size; ++k)
          for (int i = 0; i < below.size; ++i) x[below.row + i] -= L[k * below.size + i] * x[c.row + k];
      }
      for (int k = 0; k < c.size; ++k) x[c.row + k] = x[c.row + k] / D[k * (c.size + 1)];
    }
    for (auto c = columns.rbegin(); c != columns.rend(); ++c) {
      for (int b = c->first; b < c->last; ++b) {
        const BlockPattern::Block& block = pattern_->blocks()[at(b)];
        const BlockPattern::Column& below = columns[at(block.place)];
        const S* L = values_.data() + block.offset;
        if (c->size == 3 && below.size == 3) {
          x.template segment<3>(c->row) -=
              Eigen::Map<const Mat3<S>>(L).transpose().lazyProduct(x.template segment<3>(below.row));
          continue;
        }
        for (int k = 0; k < c->size; ++k)
          for (int i = 0; i < below.size; ++i) x[c->row + k] -= L[k * below.size + i] * x[below.row + i];
      }
      const S* D = values_.data() + c->diagonal;
      for (int k = c->size - 1; k >= 0; --k)
        for (int i = k + 1; i < c->size; ++i) x[c->row + k] -= D[k * c->size + i] * x[c->row + i];
      for (int k = 0; k < c->size; ++k)
        if (held_[at(c->row + k)] != 0) x[c->row + k] = S(0.0);
    }
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
  static std::size_t at(int i) { return static_cast<std::size_t>(i); }

  void eliminate(const BlockPattern::Column& c) {
    if (c.size == 3)
      eliminate_diagonal<3>(c);
    else
      eliminate_diagonal<Eigen::Dynamic>(c);
    const auto& columns = pattern_->columns();
    const auto& blocks = pattern_->blocks();
    int update = c.first_update;
    // X = L D of the blocks below, while L itself replaces them.
    scaled_.resize(at(c.last - c.first) * kMaxBlock * kMaxBlock);
    for (int b = c.first; b < c.last; ++b)
      divide(c, blocks[at(b)].offset, columns[at(blocks[at(b)].place)].size, scaled(b - c.first));
    for (int b = c.first; b < c.last; ++b) {
      const int rows_b = columns[at(blocks[at(b)].place)].size;
      const S* L = values_.data() + blocks[at(b)].offset;
      for (int a = b; a < c.last; ++a, ++update) {
        const int rows_a = columns[at(blocks[at(a)].place)].size;
        subtract_product(scaled(a - c.first), rows_a, L, rows_b, c.size,
                         values_.data() + pattern_->updates()[at(update)]);
      }
    }
  }

  S* scaled(int b) { return scaled_.data() + b * kMaxBlock * kMaxBlock; }

  /// The diagonal block into its L and D, in place.
  template <int Size>
  void eliminate_diagonal(const BlockPattern::Column& c) {
    const int n = Size == Eigen::Dynamic ? c.size : Size;
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
        A[j * n + j] = S(1.0);
        for (int i = j + 1; i < n; ++i) A[j * n + i] = S(0.0);
        continue;
      }
      smallest_ = left < smallest_ * from ? left / from : smallest_;
      A[j * n + j] = d;
      for (int i = j + 1; i < n; ++i) {
        S sum = A[j * n + i];
        for (int k = 0; k < j; ++k) sum -= A[k * n + i] * A[k * n + j] * A[k * n + k];
        A[j * n + i] = sum / d;
      }
    }
  }

  /// A block B below: X from X L^T = B, then B = X D^-1, with zero columns for held rows.
  void divide(const BlockPattern::Column& c, int offset, int rows, S* X) {
    S* B = values_.data() + offset;
    const S* A = values_.data() + c.diagonal;
    for (int k = 0; k < c.size; ++k) {
      S* x = X + k * rows;
      for (int i = 0; i < rows; ++i) x[i] = B[k * rows + i];
      for (int m = 0; m < k; ++m)
        for (int i = 0; i < rows; ++i) x[i] -= X[m * rows + i] * A[m * c.size + k];
      if (held_[at(c.row + k)] != 0) {
        for (int i = 0; i < rows; ++i) x[i] = B[k * rows + i] = S(0.0);
        continue;
      }
      const S inverse = S(1.0) / A[k * (c.size + 1)];
      for (int i = 0; i < rows; ++i) B[k * rows + i] = x[i] * inverse;
    }
  }

  /// C -= X L^T.
  static void subtract_product(const S* X, int rows_x, const S* L, int rows_l, int n, S* C) {
    if (rows_x == 3 && rows_l == 3 && n == 3) {
      Eigen::Map<Mat3<S>> out(C);
      out -= Eigen::Map<const Mat3<S>>(X).lazyProduct(Eigen::Map<const Mat3<S>>(L).transpose());
      return;
    }
    for (int j = 0; j < rows_l; ++j)
      for (int k = 0; k < n; ++k)
        for (int i = 0; i < rows_x; ++i) C[j * rows_x + i] -= X[k * rows_x + i] * L[k * rows_l + j];
  }

  const BlockPattern* pattern_ = nullptr;
  std::vector<S> values_, scaled_;
  std::vector<double> diagonal_;
  std::vector<std::uint8_t> held_;
  double smallest_ = 1, vanished_ = kVanished;
  bool keep_ = false;
};

}  // namespace pliant
