// Pattern and elimination of the linear system of Newton's method.
#pragma once

#include <pliant/solve/mover_system.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>

#include <Eigen/LU>

#include <pliant/math/header_only.h>
#include <pliant/math/scalar/power_of_two.h>

namespace pliant {

namespace detail {

/// Weight of a row before raise_weight() raises it. Rows of velocities on which no contact depends keep this
/// weight, so that the elimination does not use them as pivots of other columns.
inline constexpr double kLeastWeight = 0x1p-200;

/// Inserts i into a sorted list unless the list contains it.
inline void insert_sorted(std::vector<int>& sorted, int i) {
  const auto place = std::lower_bound(sorted.begin(), sorted.end(), i);
  if (place == sorted.end() || *place != i) sorted.insert(place, i);
}

/// Replaces A by its inverse, by Gauss-Jordan elimination with exchanges of rows. For a small N this is
/// several times as fast as A.inverse(). If a pivot is zero, the result is not finite.
template <int N>
void invert(Eigen::Matrix<double, N, N>& A) {
  std::array<Eigen::Index, N> pivot_row;
  for (Eigen::Index k = 0; k < N; ++k) {
    Eigen::Index& p = pivot_row[static_cast<std::size_t>(k)];
    p = k;
    for (Eigen::Index i = k + 1; i < N; ++i)
      if (std::abs(A(i, k)) > std::abs(A(p, k))) p = i;
    if (p != k) A.row(k).swap(A.row(p));
    const double inverse = 1 / A(k, k);
    Eigen::Matrix<double, N, 1> factors = A.col(k);
    factors[k] = 0;
    for (Eigen::Index j = 0; j < N; ++j) {
      if (j == k) continue;
      const double entry = inverse * A(k, j);
      A.col(j) -= entry * factors;
      A(k, j) = entry;
    }
    A.col(k) = -inverse * factors;
    A(k, k) = inverse;
  }
  for (Eigen::Index k = N - 1; k >= 0; --k)
    if (const Eigen::Index p = pivot_row[static_cast<std::size_t>(k)]; p != k) A.col(k).swap(A.col(p));
}

}  // namespace detail

PLIANT_INLINE int MoverSystem::add_mover(int size) {
  movers_.emplace_back().size = size;
  return static_cast<int>(movers_.size()) - 1;
}

PLIANT_INLINE void MoverSystem::couple(int i, int j) {
  if (i == j) return;
  detail::insert_sorted(movers_[at(i)].neighbours, j);
  detail::insert_sorted(movers_[at(j)].neighbours, i);
}

PLIANT_INLINE bool MoverSystem::order(double max_fill) {
  std::set<std::pair<std::size_t, int>>
      remaining;  // remaining movers, sorted by the number of their neighbours
  for (int i = 0; i < static_cast<int>(movers_.size()); ++i)
    remaining.insert({movers_[at(i)].neighbours.size(), i});
  std::vector<int> merged;
  int row = 0;
  std::size_t numbers = 0, targets = 0;
  double max_numbers = 0;
  for (const Mover& mover : movers_) max_numbers += max_fill * mover.size * mover.size;
  while (!remaining.empty()) {
    if (static_cast<double>(numbers) > max_numbers) return false;
    const int k = remaining.begin()->second;
    remaining.erase(remaining.begin());
    Mover& eliminated = movers_[at(k)];
    eliminated.position = static_cast<int>(sequence_.size());
    eliminated.row = row;
    row += eliminated.size;
    eliminated.numbers = numbers;
    numbers += at(eliminated.size * eliminated.size);
    for (const int i : eliminated.neighbours) {
      const int size = movers_[at(i)].size;
      eliminated.uniform = eliminated.uniform && size == eliminated.size;
      numbers += at(2 * eliminated.size * size);
      std::vector<int>& neighbours = movers_[at(i)].neighbours;
      remaining.erase({neighbours.size(), i});
      merged.clear();
      std::set_union(neighbours.begin(), neighbours.end(), eliminated.neighbours.begin(),
                     eliminated.neighbours.end(), std::back_inserter(merged));
      merged.erase(std::remove_if(merged.begin(), merged.end(), [&](int j) { return j == i || j == k; }),
                   merged.end());
      neighbours.swap(merged);
      remaining.insert({neighbours.size(), i});
    }
    eliminated.targets = targets;
    targets += eliminated.neighbours.size() * eliminated.neighbours.size();
    sequence_.push_back(k);
  }
  targets_.reserve(targets);
  for (const int k : sequence_)
    for (const int j : movers_[at(k)].neighbours)
      for (const int i : movers_[at(k)].neighbours) targets_.push_back(block(i, j).first);
  numbers_.resize(static_cast<Eigen::Index>(numbers));
  b_.resize(row);
  weight_.setConstant(row, detail::kLeastWeight);
  return true;
}

PLIANT_INLINE MoverSystem::Block MoverSystem::block(int i, int j) const {
  const Mover &one = movers_[at(i)], &other = movers_[at(j)];
  if (i == j) return {one.numbers, one.size};
  const bool above = one.position < other.position;
  const Mover& first = above ? one : other;
  std::size_t numbers = first.numbers + at(first.size * first.size);
  auto k = first.neighbours.begin();
  for (; *k != (above ? j : i); ++k) numbers += at(2 * first.size * movers_[at(*k)].size);
  return {numbers + (above ? 0 : at(first.size * movers_[at(*k)].size)), one.size};
}

PLIANT_INLINE void MoverSystem::clear() {
  numbers_.setZero();
  b_.setZero();
  for (const Mover& mover : movers_)
    Eigen::Map<MatX<double>>(numbers_.data() + mover.numbers, mover.size, mover.size).setIdentity();
}

template <int N>
Eigen::Matrix<double, N, N> MoverSystem::inverse_of(const Mover& k) const {
  using Numbers = Eigen::Matrix<double, N, N>;
  Numbers A = Eigen::Map<const Numbers>(numbers_.data() + k.numbers, k.size, k.size);
  if constexpr (N == 3) {
    return A.inverse();  // closed form, without pivoting
  } else {
    const auto weight = weight_.segment<N>(k.row, k.size);
    const auto scale = [&](Numbers& to, bool back) {
      for (int j = 0; j < k.size; ++j)
        for (int i = 0; i < k.size; ++i) to(i, j) *= back ? weight[j] / weight[i] : weight[i] / weight[j];
    };
    scale(A, false);
    if constexpr (N == Eigen::Dynamic)
      A = A.inverse().eval();
    else
      detail::invert(A);
    scale(A, true);
    return A;
  }
}

/// Eliminates mover k: x_k = (1 + A_kk)^-1 (b_k - sum of A_kj x_j over its remaining neighbours).
template <int N, int M>
void MoverSystem::eliminate(const Mover& k) {
  using Numbers = Eigen::Matrix<double, N, N>;
  using Above = Eigen::Map<Eigen::Matrix<double, N, M>>;
  using Left = Eigen::Map<Eigen::Matrix<double, M, N>>;
  double* numbers = numbers_.data();
  const Numbers inverse = inverse_of<N>(k);
  const Eigen::Matrix<double, N, 1> b = inverse * b_.segment<N>(k.row, k.size);
  b_.segment<N>(k.row, k.size) = b;
  const std::size_t* target = targets_.data() + k.targets;
  double *const beside = numbers + k.numbers + at(k.size * k.size), *above = beside;
  for (const int j : k.neighbours) {
    const int columns = movers_[at(j)].size;
    Above U(above, k.size, columns);
    if constexpr (N == Eigen::Dynamic)
      U = (inverse * U).eval();
    else  // without allocation
      for (int c = 0; c < columns; ++c) U.col(c) = (inverse * U.col(c)).eval();
    double* left = beside;
    for (const int i : k.neighbours) {
      const int rows = movers_[at(i)].size;
      left += k.size * rows;
      Eigen::Map<Eigen::Matrix<double, M, M>>(numbers + *target, rows, columns).noalias() -=
          Left(left, rows, k.size).lazyProduct(U);
      left += k.size * rows;
      ++target;
    }
    above += 2 * k.size * columns;
  }
  double* left = beside;
  for (const int i : k.neighbours) {
    const Mover& one = movers_[at(i)];
    left += k.size * one.size;
    b_.segment<M>(one.row, one.size) -= Left(left, one.size, k.size).lazyProduct(b);
    left += k.size * one.size;
  }
}

PLIANT_INLINE void MoverSystem::solve() {
  for (const int number : sequence_) {
    const Mover& k = movers_[at(number)];
    if (k.uniform && k.size == 3)
      eliminate<3, 3>(k);
    else if (k.uniform && k.size == 6)
      eliminate<6, 6>(k);
    else if (k.size == 3)
      eliminate<3, Eigen::Dynamic>(k);
    else if (k.size == 6)
      eliminate<6, Eigen::Dynamic>(k);
    else
      eliminate<Eigen::Dynamic, Eigen::Dynamic>(k);
  }
  for (auto number = sequence_.rbegin(); number != sequence_.rend(); ++number) {
    const Mover& k = movers_[at(*number)];
    auto x = b_.segment(k.row, k.size);
    const double* above = numbers_.data() + k.numbers + at(k.size * k.size);
    for (const int j : k.neighbours) {
      const Mover& other = movers_[at(j)];
      x -= Eigen::Map<const MatX<double>>(above, k.size, other.size)
               .lazyProduct(b_.segment(other.row, other.size));
      above += 2 * k.size * other.size;
    }
  }
}

}  // namespace pliant
