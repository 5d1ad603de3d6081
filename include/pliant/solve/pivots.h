// The pivots of an L D L^T of a symmetric positive semi-definite matrix. Rows that depend on those before
// them are found by their vanishing pivot and held: their unknown is 0, and all else is solved as if they
// were not there. S is double or Dual<1>.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <pliant/math/index.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/math/types.h>

namespace pliant {

/// How rows that depend on others are told: by a vanished pivot; by the factor before, as where joints are a
/// little open within a step, which makes such rows seem independent; or only where nothing but rounding is
/// left of a pivot, next to a singular position.
enum class RankRule { decide, keep, rounding };

template <class S>
class Pivots {
 public:
  /// A pivot at or below this part of its diagonal entry has vanished, and one of which only rounding is
  /// left.
  static constexpr double kVanished = 1e-9, kRounding = 1e-12;

  /// For a matrix of so many rows. RankRule::keep holds what was held before, and takes as many rows.
  void clear(int rows, RankRule rule) {
    keep_ = rule == RankRule::keep;
    vanished_ = rule == RankRule::decide ? kVanished : kRounding;
    smallest_ = 1;
    entry_.resize(at(rows));
    inverse_.resize(at(rows));
    if (!keep_) held_.assign(at(rows), 0);
    measures_.clear();
  }
  /// The pivot of a row, whose diagonal entry is what is left of larger ones, is measured by those.
  void measure_by(int row, double entry) { measures_.push_back({row, entry}); }

  /// The diagonal entries, before the elimination, are what pivots are measured by.
  void set_entry(int row, const S& entry) { entry_[at(row)] = plain(entry); }
  void take_measures() {
    for (const Measure& m : measures_) entry_[at(m.row)] = std::max(entry_[at(m.row)], m.entry);
  }

  /// Takes the pivot of a row; returns whether it counts. Otherwise the row is held.
  bool take(int row, const S& pivot) {
    const double from = entry_[at(row)], left = plain(pivot);
    // What is not a number is left to the finite check.
    if ((keep_ && held(row)) || (std::isfinite(from) && !(left > vanished_ * from))) {
      held_[at(row)] = 1;
      inverse_[at(row)] = S(0.0);
      return false;
    }
    if (left < smallest_ * from) smallest_ = left / from;
    inverse_[at(row)] = S(1.0) / pivot;
    return true;
  }

  /// 1 / pivot, or 0 of a held row.
  const S& inverse(int row) const { return inverse_[at(row)]; }
  bool held(int row) const { return held_[at(row)] != 0; }
  int rank() const { return static_cast<int>(std::count(held_.begin(), held_.end(), 0)); }
  /// The smallest pivot that counts, as part of its diagonal entry: digits that the elimination cost.
  double smallest() const { return smallest_; }

 private:
  struct Measure {
    int row;
    double entry;
  };

  std::vector<S> inverse_;
  std::vector<double> entry_;
  std::vector<Measure> measures_;
  std::vector<std::uint8_t> held_;
  double smallest_ = 1, vanished_ = kVanished;
  bool keep_ = false;
};

}  // namespace pliant
