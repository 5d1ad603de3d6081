// Assembly of the contact problem, its clusters, and the velocities that the search uses.
#pragma once

#include <pliant/solve/coulomb_system.h>

#include <algorithm>

#include <pliant/math/disjoint_sets.h>

#include <pliant/math/header_only.h>
#include <pliant/solve/coulomb_cluster.h>

namespace pliant {

namespace detail {
/// The diagonal of W of each contact grows by this fraction of its largest entry, so that W has full rank.
inline constexpr double kContactRegularisation = 1e-12;
}  // namespace detail

PLIANT_INLINE CoulombSystem::CoulombSystem() : scratch_(std::make_unique<CoulombScratch>()) {}
PLIANT_INLINE CoulombSystem::~CoulombSystem() = default;

PLIANT_INLINE void CoulombSystem::reserve(std::size_t contacts) {
  constexpr std::size_t kSides = 2, kNumbers = 3 * 6;  // of a contact of two bodies; of a side or push
  contacts_.reserve(contacts);
  p_.reserve(contacts);
  sides_.reserve(kSides * contacts);
  pushes_.reserve(kSides * contacts);
  numbers_.reserve(2 * kSides * kNumbers * contacts);
}

PLIANT_INLINE int CoulombSystem::add_mover(int size) {
  movers_.push_back(movers_.back() + size);
  return static_cast<int>(movers_.size()) - 2;
}

PLIANT_INLINE void CoulombSystem::begin_contact(int rows, double mu) {
  Contact contact;
  contact.rows = rows;
  contact.mu = mu;
  contact.first_side = contact.last_side = static_cast<int>(sides_.size());
  contact.first_push = contact.last_push = static_cast<int>(pushes_.size());
  contacts_.push_back(contact);
  p_.push_back(Vec3<double>::Zero());
}

PLIANT_INLINE void CoulombSystem::add_contact(double mu) {
  begin_contact(3, mu);
}

PLIANT_INLINE void CoulombSystem::add_row() {
  begin_contact(1, 0);
}

PLIANT_INLINE void CoulombSystem::add_limit() {
  begin_contact(1, 0);
  contacts_.back().is_limit = true;
}

PLIANT_INLINE CoulombSystem::Term CoulombSystem::term(int mover, int first, int size) {
  const Term term{mover, this->first(mover) + first, size, numbers_.size()};
  numbers_.resize(numbers_.size() + at(3 * size), 0.0);
  return term;
}

PLIANT_INLINE CoulombSystem::Side CoulombSystem::add_side(int mover, int first, int size) {
  sides_.push_back(term(mover, first, size));
  ++contacts_.back().last_side;
  return Side(numbers_.data() + sides_.back().numbers, 3, size);
}

PLIANT_INLINE CoulombSystem::Push CoulombSystem::add_push(int mover) {
  pushes_.push_back(term(mover, 0, mover_size(mover)));
  ++contacts_.back().last_push;
  return push(size() - 1, pushes(size() - 1) - 1);
}

PLIANT_INLINE CoulombSystem::Push CoulombSystem::push(int k, int i) {
  const Term& term = pushes_[at(contacts_[at(k)].first_push + i)];
  return Push(numbers_.data() + term.numbers, term.size, 3);
}

PLIANT_INLINE void CoulombSystem::drop_pushes() {
  contacts_.back().last_push = contacts_.back().first_push;
}

PLIANT_INLINE Mat3<double> CoulombSystem::effect(int i, int j) const {
  Mat3<double> A = Mat3<double>::Zero();
  for (int s = contacts_[at(i)].first_side; s < contacts_[at(i)].last_side; ++s)
    for (int r = contacts_[at(j)].first_push; r < contacts_[at(j)].last_push; ++r) {
      const Term &side = sides_[at(s)], &push = pushes_[at(r)];
      if (side.first < push.first || side.first >= push.first + push.size) continue;
      const double *J = numbers_.data() + side.numbers, *Y = numbers_.data() + push.numbers;
      if (side.size == 6 && push.size == 6)
        A += Eigen::Map<const Eigen::Matrix<double, 3, 6>>(J).lazyProduct(
            Eigen::Map<const Eigen::Matrix<double, 6, 3>>(Y));
      else
        A.noalias() +=
            Eigen::Map<const Eigen::Matrix3Xd>(J, 3, side.size) *
            Eigen::Map<const MatX<double>>(Y, push.size, 3).middleRows(side.first - push.first, side.size);
    }
  return A;
}

PLIANT_INLINE Vec3<double> CoulombSystem::velocity(int k, const VecX<double>& x) const {
  return velocity_at(k, sides_, x);
}

PLIANT_INLINE Vec3<double> CoulombSystem::velocity_at(int k, const std::vector<Term>& terms,
                                                      const VecX<double>& x) const {
  const Contact& contact = contacts_[at(k)];
  Vec3<double> u = contact.c;
  for (int s = contact.first_side; s < contact.last_side; ++s) {
    const Term& side = terms[at(s)];
    const double* J = numbers_.data() + side.numbers;
    if (side.size == 3)
      u.noalias() += Eigen::Map<const Mat3<double>>(J) * x.segment<3>(side.first);
    else if (side.size == 6)
      u.noalias() += Eigen::Map<const Eigen::Matrix<double, 3, 6>>(J) * x.segment<6>(side.first);
    else
      u.noalias() += Eigen::Map<const Eigen::Matrix3Xd>(J, 3, side.size) * x.segment(side.first, side.size);
  }
  return u;
}

PLIANT_INLINE void CoulombSystem::add_change(int k, double factor, VecX<double>& x) const {
  add_change_to(k, factor * p_[at(k)], pushes_, x);
}

/// Computes x += Y_k p. terms: pushes_, or used_pushes_ if x has the used velocities only.
PLIANT_INLINE void CoulombSystem::add_change_to(int k, const Vec3<double>& p, const std::vector<Term>& terms,
                                                VecX<double>& x) const {
  for (int r = contacts_[at(k)].first_push; r < contacts_[at(k)].last_push; ++r) {
    const Term& push = terms[at(r)];
    const double* Y = numbers_.data() + push.numbers;
    if (push.size == 3)
      x.segment<3>(push.first).noalias() += Eigen::Map<const Mat3<double>>(Y) * p;
    else if (push.size == 6)
      x.segment<6>(push.first).noalias() += Eigen::Map<const Eigen::Matrix<double, 6, 3>>(Y) * p;
    else
      x.segment(push.first, push.size).noalias() += Eigen::Map<const MatX<double>>(Y, push.size, 3) * p;
  }
}

PLIANT_INLINE void CoulombSystem::complete() {
  complete_ = true;
  for (int k = 0; k < size(); ++k) {
    Contact& contact = contacts_[at(k)];
    const Mat3<double> W = effect(k, k);
    contact.W = 0.5 * (W + W.transpose());
    contact.W.diagonal().array() += detail::kContactRegularisation * contact.W.diagonal().maxCoeff();
  }
  select_used();
  find_clusters();
}

/// Selects the velocities that a side depends on, and copies the terms for them. All velocities of a mover
/// without sides are selected.
PLIANT_INLINE void CoulombSystem::select_used() {
  std::vector<char> is_used(at(n_x()), 0);
  std::vector<char> has_side(movers_.size() - 1, 0);
  for (const Term& side : sides_) {
    std::fill_n(is_used.begin() + side.first, side.size, 1);
    has_side[at(side.mover)] = 1;
  }
  for (int i = 0; i < movers(); ++i)
    if (!has_side[at(i)]) std::fill_n(is_used.begin() + first(i), mover_size(i), 1);
  used_.clear();
  std::vector<int> before{0};  // number of selected velocities before each velocity
  for (int i = 0; i < n_x(); ++i) {
    if (is_used[at(i)]) used_.push_back(i);
    before.push_back(static_cast<int>(used_.size()));
  }
  used_movers_.clear();
  for (const int first_of_mover : movers_) used_movers_.push_back(before[at(first_of_mover)]);
  used_sides_ = sides_;
  for (Term& side : used_sides_) side.first = before[at(side.first)];
  used_pushes_ = pushes_;
  std::size_t more = 0;
  for (const Term& push : pushes_) more += at(3 * push.size);
  if (used_.size() < is_used.size()) numbers_.reserve(numbers_.size() + more);
  for (Term& push : used_pushes_) {
    const int first = before[at(push.first)], size = before[at(push.first + push.size)] - first;
    if (size < push.size) {
      const std::size_t numbers = numbers_.size();
      numbers_.resize(numbers + at(3 * size));
      const Push all(numbers_.data() + push.numbers, push.size, 3);
      Push used(numbers_.data() + numbers, size, 3);
      for (int i = 0; i < size; ++i) used.row(i) = all.row(used_[at(first + i)] - push.first);
      push.numbers = numbers;
    }
    push.first = first;
    push.size = size;
  }
}

/// Finds the clusters. Sorts the contacts with sides by cluster; within a cluster their order does not
/// change.
PLIANT_INLINE void CoulombSystem::find_clusters() {
  DisjointSets tied(movers_.size() - 1);
  std::vector<int> mover(contacts_.size());
  for (int k = 0; k < size(); ++k) {
    const Contact& contact = contacts_[at(k)];
    if (sides(k) == 0) continue;
    mover[at(k)] = sides_[at(contact.first_side)].mover;
    for (int s = contact.first_side + 1; s < contact.last_side; ++s)
      tied.unite(mover[at(k)], sides_[at(s)].mover);
  }
  order_.clear();
  for (int k = 0; k < size(); ++k)
    if (sides(k) > 0) {
      mover[at(k)] = tied.root(mover[at(k)]);
      order_.push_back(k);
    }
  std::stable_sort(order_.begin(), order_.end(), [&](int i, int j) { return mover[at(i)] < mover[at(j)]; });
  clusters_.clear();
  for (int i = 0; i < static_cast<int>(order_.size()); ++i)
    if (i == 0 || mover[at(order_[at(i)])] != mover[at(order_[at(i - 1)])]) clusters_.push_back(i);
  clusters_.push_back(static_cast<int>(order_.size()));
}

PLIANT_INLINE CoulombResult CoulombSystem::solve(VecX<double>& x, const CoulombTolerance& tolerance) {
  if (!complete_) complete();
  CoulombResult result;
  x0_.resize(static_cast<Eigen::Index>(used_.size()));
  for (Eigen::Index i = 0; i < x0_.size(); ++i) x0_[i] = x[used_[static_cast<std::size_t>(i)]];
  x_ = x0_;
  for (int k = 0; k < size(); ++k) {
    if (pushes(k) == 0) p_[at(k)].setZero();
    add_change_to(k, p_[at(k)], used_pushes_, x_);
    if (sides(k) == 0) result.residual = std::max(result.residual, -velocity(k, x)[0]);
  }
  for (int i = 0; i + 1 < static_cast<int>(clusters_.size()); ++i)
    CoulombCluster(*this, i, tolerance, *scratch_).solve(result);
  // The search accumulates rounding errors in the velocities. Compute them from the final impulses.
  for (int k = 0; k < size(); ++k) add_change(k, 1, x);
  return result;
}

}  // namespace pliant
