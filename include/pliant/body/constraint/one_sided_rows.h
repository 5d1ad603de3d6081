// One-sided rows of a group and the pushes (forces or impulses) that satisfy these rows: the least change of
// x (group.h) in the mass metric. Each push lambda is >= 0, and zero unless its row is at its bound. The
// response to a push includes the reactions of the joints of the group.
#pragma once

#include <array>
#include <type_traits>
#include <vector>

#include <pliant/body/constraint/group.h>
#include <pliant/solve/complementarity.h>

namespace pliant {

template <int Max>
class OneSidedRows {
 public:
  using Vector = VecMax<double, Max>;
  static constexpr bool kAlone = Max != Eigen::Dynamic;  ///< one part without joints: no heap memory
  static constexpr int kMaxRows = kAlone ? kMaxLimitRows : Eigen::Dynamic;

  explicit OneSidedRows(const Group<double, Max>& group) : group_(group) {}

  bool empty() const { return n_ == 0; }
  /// Adds a row.
  void add(const OneSidedRow& row) {
    if constexpr (!kAlone) {
      rows_.emplace_back();
      responses_.emplace_back();
    }
    rows_[n_] = row;
    responses_[n_++] = group_.response(row);
  }
  /// Adds all rows of the group that x violates and that were not added before, except rows of parameters
  /// without inertia. Returns whether a row was added. bound(row): the bound of a row.
  template <class Bound>
  bool add_violated(const Vector& x, Bound&& bound) {
    const std::size_t before = n_;
    auto check = [&](OneSidedRow row) {
      row.bound = bound(row);
      if (group_.value(row, x) < row.bound && !has(row)) add(row);
    };
    for (int i = 0; i < group_.parts(); ++i)
      for (int k = 0; k < group_.model(i).n_s; ++k) {
        if (group_.workspace(i).without_inertia(6 + k)) continue;
        check({i, k, 1, 0});
        check({i, k, -1, 0});
      }
    for (int k = 0; group_.island() != nullptr && k < static_cast<int>(group_.island()->strings.size());
         ++k) {
      check({-1, k, 1, 0});
      check({-1, k, -1, 0});
    }
    return n_ > before;
  }

  /// Computes the pushes that satisfy the rows added so far. Returns x with these pushes.
  Vector satisfy(const Vector& x) {
    const auto n = static_cast<Eigen::Index>(n_);
    MatMax<double, kMaxRows> W(n, n);
    VecMax<double, kMaxRows> b(n);
    for (std::size_t i = 0; i < n_; ++i) {
      const auto r = static_cast<Eigen::Index>(i);
      b[r] = group_.value(rows_[i], x) - rows_[i].bound;
      for (std::size_t j = 0; j < n_; ++j)
        W(r, static_cast<Eigen::Index>(j)) = group_.value(rows_[i], responses_[j]);
      W(r, r) *= 1 + rows_[i].softness;
    }
    lambda_ = solve_complementarity(W, b).lambda;
    Vector after = x;
    for (std::size_t i = 0; i < n_; ++i)
      if (pushed(i)) after += responses_[i] * lambda_[static_cast<Eigen::Index>(i)];
    for (std::size_t i = 0; i < n_; ++i) {
      const OneSidedRow& row = rows_[i];
      if (!pushed(i)) continue;
      if (row.part >= 0)
        after[group_.first(row.part) + 6 + row.k] = row.sign * row.bound;  // without rounding errors
    }
    return after;
  }
  /// Changes x so that x satisfies all rows of the group with the bounds bound(row), including rows that the
  /// pushes on other rows would violate.
  template <class Bound>
  void satisfy_all(Vector& x, Bound&& bound) {
    if (!add_violated(x, bound)) return;
    Vector now = satisfy(x);
    while (add_violated(now, bound)) now = satisfy(x);
    x = now;
  }

  /// Calls act(row, lambda) for each row with a push > 0 in the last satisfy(). Returns the number of these
  /// rows.
  template <class F>
  int for_each_pushed(F&& act) const {
    int count = 0;
    for (std::size_t i = 0; i < n_; ++i)
      if (pushed(i)) {
        act(rows_[i], lambda_[static_cast<Eigen::Index>(i)]);
        ++count;
      }
    return count;
  }

  /// Sets the softness of the rows for which which(row) is true.
  template <class Which>
  void soften(double softness, Which&& which) {
    for (std::size_t i = 0; i < n_; ++i)
      if (which(rows_[i])) rows_[i].softness = softness;
  }

 private:
  template <class T>
  using List = std::conditional_t<kAlone, std::array<T, kMaxLimitRows>, std::vector<T>>;

  bool pushed(std::size_t i) const { return lambda_[static_cast<Eigen::Index>(i)] > 0; }
  bool has(const OneSidedRow& row) const {
    for (std::size_t i = 0; i < n_; ++i)
      if (rows_[i].part == row.part && rows_[i].k == row.k && rows_[i].sign == row.sign) return true;
    return false;
  }

  const Group<double, Max>& group_;
  std::size_t n_ = 0;
  List<OneSidedRow> rows_;
  List<Vector> responses_;
  VecMax<double, kMaxRows> lambda_;
};

}  // namespace pliant
