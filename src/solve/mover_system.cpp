#include "mover_system.h"

#include <algorithm>
#include <iterator>

#include <Eigen/LU>

namespace pliant {

namespace {

using Block3 = Eigen::Map<Mat3<double>>;

void insert(std::vector<int>& sorted, int i) {
  const auto place = std::lower_bound(sorted.begin(), sorted.end(), i);
  if (place == sorted.end() || *place != i) sorted.insert(place, i);
}

}  // namespace

int MoverSystem::add_mover(int size) {
  movers_.emplace_back().size = size;
  return static_cast<int>(movers_.size()) - 1;
}

void MoverSystem::couple(int i, int j) {
  if (i == j) return;
  insert(movers_[at(i)].near, j);
  insert(movers_[at(j)].near, i);
}

void MoverSystem::order() {
  std::vector<int> left, merged;
  for (int i = 0; i < static_cast<int>(movers_.size()); ++i) {
    movers_[at(i)].turn = -1;
    if (is_point(i)) {
      left.push_back(i);
      continue;
    }
    movers_[at(i)].row = n_others_;
    n_others_ += movers_[at(i)].size;
  }
  int row = n_others_;
  std::size_t numbers = at(n_others_) * at(n_others_), targets = 0;
  while (!left.empty()) {
    const auto next = std::min_element(left.begin(), left.end(), [&](int i, int j) {
      return movers_[at(i)].near.size() < movers_[at(j)].near.size();
    });
    const int k = *next;
    left.erase(next);
    Mover& eliminated = movers_[at(k)];
    eliminated.turn = static_cast<int>(points_.size());
    eliminated.row = row;
    row += 3;
    eliminated.numbers = numbers;
    numbers += 9;
    for (const int i : eliminated.near) {
      numbers += at(2 * 3 * movers_[at(i)].size);
      std::vector<int>& near = movers_[at(i)].near;
      merged.clear();
      std::set_union(near.begin(), near.end(), eliminated.near.begin(), eliminated.near.end(),
                     std::back_inserter(merged));
      merged.erase(std::remove_if(merged.begin(), merged.end(), [&](int j) { return j == i || j == k; }),
                   merged.end());
      near.swap(merged);
    }
    eliminated.targets = targets;
    targets += eliminated.near.size() * eliminated.near.size();
    points_.push_back(k);
  }
  targets_.reserve(targets);
  for (const int k : points_)
    for (const int j : movers_[at(k)].near)
      for (const int i : movers_[at(k)].near) targets_.push_back(block(i, j).first);
  numbers_.resize(static_cast<Eigen::Index>(numbers));
  b_.resize(row);
}

MoverSystem::Block MoverSystem::block(int i, int j) const {
  const Mover &one = movers_[at(i)], &other = movers_[at(j)];
  if (one.turn < 0 && other.turn < 0) return {at(other.row) * at(n_others_) + at(one.row), n_others_};
  if (i == j) return {one.numbers, 3};
  const bool above = other.turn < 0 || (one.turn >= 0 && one.turn < other.turn);
  const Mover& first = above ? one : other;
  std::size_t numbers = first.numbers + 9;
  auto k = first.near.begin();
  for (; *k != (above ? j : i); ++k) numbers += at(2 * 3 * movers_[at(*k)].size);
  return {numbers + (above ? 0 : at(3 * movers_[at(*k)].size)), one.size};
}

void MoverSystem::clear() {
  numbers_.setZero();
  b_.setZero();
  for (int i = 0; i < n_others_; ++i) numbers_[i * (n_others_ + 1)] = 1;
  for (const int k : points_) Block3(numbers_.data() + movers_[at(k)].numbers).setIdentity();
}

/// x_k = b_k - sum of A_kj x_j over the neighbours that are left.
void MoverSystem::eliminate(const Mover& k) {
  double* numbers = numbers_.data();
  const Mat3<double> inverse = Block3(numbers + k.numbers).inverse();
  const Vec3<double> b = inverse * b_.segment<3>(k.row);
  b_.segment<3>(k.row) = b;
  const std::size_t* target = targets_.data() + k.targets;
  double* above = numbers + k.numbers + 9;
  for (const int j : k.near) {
    const int size = movers_[at(j)].size;
    Eigen::Map<Eigen::Matrix3Xd> U(above, 3, size);
    for (Eigen::Index c = 0; c < size; ++c) U.col(c) = (inverse * U.col(c)).eval();
    const double* left = numbers + k.numbers + 9;
    for (const int i : k.near) {
      const int rows = movers_[at(i)].size;
      left += 3 * rows;
      if (size == 3 && rows == 3) {
        Block3(numbers + *target).noalias() -=
            Eigen::Map<const Mat3<double>>(left).lazyProduct(Block3(above));
      } else {
        const int stride = size == 3 || rows == 3 ? rows : n_others_;
        Eigen::Map<MatX<double>, 0, Eigen::OuterStride<>>(numbers + *target, rows, size,
                                                          Eigen::OuterStride<>(stride))
            .noalias() -= Eigen::Map<const MatX<double>>(left, rows, 3).lazyProduct(U);
      }
      left += 3 * rows;
      ++target;
    }
    above += 6 * size;
  }
  const double* left = numbers + k.numbers + 9;
  for (const int i : k.near) {
    const Mover& one = movers_[at(i)];
    left += 3 * one.size;
    b_.segment(one.row, one.size) -= Eigen::Map<const MatX<double>>(left, one.size, 3).lazyProduct(b);
    left += 3 * one.size;
  }
}

void MoverSystem::solve_others() {
  if (n_others_ == 0) return;
  Eigen::Map<MatX<double>> A(numbers_.data(), n_others_, n_others_);
  const Eigen::PartialPivLU<Eigen::Ref<MatX<double>>> factor(A);
  b_.head(n_others_) = factor.solve(b_.head(n_others_)).eval();
}

void MoverSystem::solve() {
  for (const int k : points_) eliminate(movers_[at(k)]);
  solve_others();
  for (auto k = points_.rbegin(); k != points_.rend(); ++k) {
    const Mover& point = movers_[at(*k)];
    auto x = b_.segment<3>(point.row);
    const double* above = numbers_.data() + point.numbers + 9;
    for (const int j : point.near) {
      const Mover& other = movers_[at(j)];
      x -= Eigen::Map<const Eigen::Matrix3Xd>(above, 3, other.size)
               .lazyProduct(b_.segment(other.row, other.size));
      above += 6 * other.size;
    }
  }
}

}  // namespace pliant
