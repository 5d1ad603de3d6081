#include "mover_system.h"

#include <Eigen/LU>

namespace pliant {

void MoverSystem::begin(int n_x) {
  n_movers_ = 0;
  mover_of_.assign(at(n_x), -1);
}

void MoverSystem::add_mover(int first, int size) {
  if (mover_of_[at(first)] >= 0) return;
  for (int x = first; x < first + size; ++x) mover_of_[at(x)] = n_movers_;
  if (movers_.size() == at(n_movers_)) movers_.emplace_back();
  Mover& mover = movers_[at(n_movers_++)];
  mover.first = first;
  mover.size = size;
}

void MoverSystem::number() {
  row_of_.resize(mover_of_.size());
  Eigen::Index row = 0;
  for (int i = 0; i < n_movers_; ++i) {
    movers_[at(i)].row = row;
    for (int x = movers_[at(i)].first; x < movers_[at(i)].first + movers_[at(i)].size; ++x)
      row_of_[at(x)] = row++;
  }
  A_.resize(row, row);
  b_.resize(row);
  coupled_.assign(at(n_movers_) * at(n_movers_), 0);
}

void MoverSystem::couple(int x, int y) {
  set_coupled(mover_of_[at(x)], mover_of_[at(y)]);
  set_coupled(mover_of_[at(y)], mover_of_[at(x)]);
}

void MoverSystem::order() {
  points_.clear();
  others_.clear();
  for (int i = 0; i < n_movers_; ++i) {
    Mover& mover = movers_[at(i)];
    mover.done = false;
    mover.neighbours = 0;
    for (int j = 0; j < n_movers_; ++j) mover.neighbours += i != j && coupled(i, j) ? 1 : 0;
    if (mover.size != 3) others_.push_back(i);
  }
  while (points_.size() + others_.size() < at(n_movers_)) {
    int next = -1;
    for (int i = 0; i < n_movers_; ++i) {
      const Mover& mover = movers_[at(i)];
      if (mover.size != 3 || mover.done) continue;
      if (next < 0 || mover.neighbours < movers_[at(next)].neighbours) next = i;
    }
    Mover& eliminated = movers_[at(next)];
    eliminated.done = true;
    eliminated.after.clear();
    for (int j = 0; j < n_movers_; ++j)
      if (coupled(next, j) && !movers_[at(j)].done) eliminated.after.push_back(j);
    for (const int i : eliminated.after) {
      --movers_[at(i)].neighbours;
      for (const int j : eliminated.after) {
        if (i == j || coupled(i, j)) continue;
        set_coupled(i, j);
        ++movers_[at(i)].neighbours;
      }
    }
    points_.push_back(next);
  }
}

void MoverSystem::clear() {
  for (int j = 0; j < n_movers_; ++j)
    for (int i = 0; i < n_movers_; ++i) {
      const Mover &one = movers_[at(i)], &other = movers_[at(j)];
      if (i == j)
        A_.block(one.row, one.row, one.size, one.size).setIdentity();
      else if (coupled(i, j) || (one.size != 3 && other.size != 3))
        A_.block(one.row, other.row, one.size, other.size).setZero();
    }
  b_.setZero();
}

/// x_k = b_k - sum of A_kj x_j over the neighbours that are left.
void MoverSystem::eliminate(const Mover& k) {
  const Mat3<double> inverse = A_.block<3, 3>(k.row, k.row).inverse();
  const Vec3<double> b = inverse * b_.segment<3>(k.row);
  b_.segment<3>(k.row) = b;
  for (const int j : k.after) {
    const Mover& other = movers_[at(j)];
    if (other.size == 3) {
      const Mat3<double> U = inverse * A_.block<3, 3>(k.row, other.row);
      A_.block<3, 3>(k.row, other.row) = U;
      for (const int i : k.after) {
        const Mover& one = movers_[at(i)];
        if (one.size == 3)
          A_.block<3, 3>(one.row, other.row) -= A_.block<3, 3>(one.row, k.row).lazyProduct(U);
        else
          A_.block(one.row, other.row, one.size, 3) -= A_.block(one.row, k.row, one.size, 3).lazyProduct(U);
      }
    } else {
      auto U = A_.block(k.row, other.row, 3, other.size);
      for (Eigen::Index c = 0; c < other.size; ++c) U.col(c) = (inverse * U.col(c)).eval();
      for (const int i : k.after) {
        const Mover& one = movers_[at(i)];
        A_.block(one.row, other.row, one.size, other.size) -=
            A_.block(one.row, k.row, one.size, 3).lazyProduct(U);
      }
    }
  }
  for (const int i : k.after) {
    const Mover& one = movers_[at(i)];
    b_.segment(one.row, one.size) -= A_.block(one.row, k.row, one.size, 3).lazyProduct(b);
  }
}

void MoverSystem::solve_others() {
  Eigen::Index n = 0;
  for (const int i : others_) n += movers_[at(i)].size;
  if (n == 0) return;
  A_others_.resize(n, n);
  b_others_.resize(n);
  Eigen::Index row = 0;
  for (const int i : others_) {
    const Mover& one = movers_[at(i)];
    b_others_.segment(row, one.size) = b_.segment(one.row, one.size);
    Eigen::Index column = 0;
    for (const int j : others_) {
      const Mover& other = movers_[at(j)];
      A_others_.block(row, column, one.size, other.size) = A_.block(one.row, other.row, one.size, other.size);
      column += other.size;
    }
    row += one.size;
  }
  const Eigen::PartialPivLU<Eigen::Ref<MatX<double>>> factor(A_others_);
  b_others_ = factor.solve(b_others_).eval();
  row = 0;
  for (const int i : others_) {
    b_.segment(movers_[at(i)].row, movers_[at(i)].size) = b_others_.segment(row, movers_[at(i)].size);
    row += movers_[at(i)].size;
  }
}

void MoverSystem::solve() {
  for (const int k : points_) eliminate(movers_[at(k)]);
  solve_others();
  for (auto k = points_.rbegin(); k != points_.rend(); ++k) {
    const Mover& point = movers_[at(*k)];
    auto x = b_.segment<3>(point.row);
    for (const int j : point.after) {
      const Mover& other = movers_[at(j)];
      if (other.size == 3)
        x -= A_.block<3, 3>(point.row, other.row).lazyProduct(b_.segment<3>(other.row));
      else
        x -= A_.block(point.row, other.row, 3, other.size).lazyProduct(b_.segment(other.row, other.size));
    }
  }
}

}  // namespace pliant
