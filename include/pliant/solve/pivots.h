// The pivots of a factorisation L D L^T of a symmetric positive semi-definite matrix. A row that depends on
// earlier rows has a vanishing pivot. The dependent row is excluded: its unknown is 0, and the other rows are
// solved without this row. Rows with small pivots are postponed, so that of several rows that depend on each
// other the one with the smallest pivot is excluded. S is double or Dual<1>.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <pliant/math/index.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/math/types.h>

namespace pliant {

/// The rule that decides which rows are dependent.
enum class RankRule {
  /// A row is dependent if its relative pivot (the ratio of pivot to scale) is at most Pivots::kVanished.
  decide,
  /// The dependent rows are those of the previous factorisation, and other rows whose relative pivot is at
  /// most Pivots::kRounding. Within a step, joints are slightly open, so that dependent rows can look
  /// independent.
  keep,
  /// A row is dependent if its relative pivot is at most Pivots::kRounding. This rule is for configurations
  /// near a singular one.
  rounding
};

/// The pivots, their scales and the excluded rows.
template <class S>
class Pivots {
 public:
  /// A pivot vanishes if its ratio to its scale (set_entry, raise_scale) is at most this: kVanished for
  /// RankRule::decide, kRounding for the other rules.
  static constexpr double kVanished = 1e-9, kRounding = 1e-12;
  /// A row is postponed if the ratio of its pivot to its scale is below this, and another row has a larger
  /// ratio. Division by a small pivot would magnify errors.
  static constexpr double kSmall = 0.1;

  /// Starts a new matrix with this number of rows. RankRule::keep keeps the excluded rows of the previous
  /// matrix, which must have had this number of rows.
  void clear(int rows, RankRule rule) {
    keep_ = rule == RankRule::keep;
    vanished_ = rule == RankRule::decide ? kVanished : kRounding;
    smallest_ = 1;
    entry_.resize(at(rows));
    inverse_.resize(at(rows));
    if (!keep_) excluded_.assign(at(rows), 0);
    measures_.clear();
  }
  /// Sets a lower bound of the scale for the pivot of a row, for a row whose diagonal entry is a difference
  /// of larger numbers. Call it after clear().
  void raise_scale(int row, double entry) { measures_.push_back({row, entry}); }

  /// Sets the scale of the pivot of a row: its diagonal entry before the elimination.
  void set_entry(int row, const S& entry) { entry_[at(row)] = plain(entry); }
  /// Applies the larger scales of raise_scale(). Call it after set_entry() of all rows.
  void apply_measures() {
    for (const Measure& m : measures_) entry_[at(m.row)] = std::max(entry_[at(m.row)], m.entry);
  }

  /// Returns whether a row with this pivot should be postponed if another row has a larger ratio.
  bool small(int row, const S& pivot) const {
    return !(keep_ && excluded(row)) && plain(pivot) < kSmall * entry_[at(row)];
  }
  /// Returns the ratio of a pivot to the scale of its row; -1 for a row that RankRule::keep excludes.
  double ratio(int row, const S& pivot) const {
    const double scale = entry_[at(row)];
    return (keep_ && excluded(row)) || !(scale > 0) ? -1 : plain(pivot) / scale;
  }

  /// Stores the pivot of a row and returns true. If the pivot vanishes, or if RankRule::keep excludes the
  /// row, excludes the row and returns false.
  bool accept(int row, const S& pivot) {
    const double scale = entry_[at(row)], value = plain(pivot);
    // A scale that is not finite excludes no row; the check of the solution for finite numbers detects such a
    // scale.
    if ((keep_ && excluded(row)) || (std::isfinite(scale) && !(value > vanished_ * scale))) {
      excluded_[at(row)] = 1;
      inverse_[at(row)] = S(0.0);
      return false;
    }
    if (value < smallest_ * scale) smallest_ = value / scale;
    inverse_[at(row)] = S(1.0) / pivot;
    return true;
  }

  /// Returns 1 / pivot, or 0 for an excluded row.
  const S& inverse(int row) const { return inverse_[at(row)]; }
  /// Returns whether a row is excluded.
  bool excluded(int row) const { return excluded_[at(row)] != 0; }
  /// Returns the number of rows that are not excluded.
  int rank() const { return static_cast<int>(std::count(excluded_.begin(), excluded_.end(), 0)); }
  /// Returns the smallest ratio of an accepted pivot to its scale, at most 1: a measure of the digits lost in
  /// the elimination.
  double smallest() const { return smallest_; }

 private:
  struct Measure {
    int row;
    double entry;
  };

  std::vector<S> inverse_;
  std::vector<double> entry_;
  std::vector<Measure> measures_;
  std::vector<std::uint8_t> excluded_;
  double smallest_ = 1, vanished_ = kVanished;
  bool keep_ = false;
};

}  // namespace pliant
