// The augmented matrix of Eq. (14): its pattern, its values, the solution with iterative refinement, and the
// rank of C_q.
#pragma once

#include <cmath>
#include <limits>

#include <Eigen/SparseQR>

#include <pliant/body/constraint/augmented.h>
#include <pliant/body/dynamics.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace detail {

/// Entry of the diagonal d (augmented.h) in a row, divided by diagonal_of_ends() of the row.
inline constexpr double kRegularisation = 1e-9;
/// dependent_rows() regards a row of C_q, scaled to unit length, as dependent on other rows if its distance
/// from their span is below this number.
inline constexpr double kDependentRow = 3e-5;
/// Largest number of refinements, and number of successive refinements without improvement that ends the
/// iteration.
inline constexpr int kMaxRefinements = 12, kMaxStalledRefinements = 3;
/// Residual, relative to the right-hand side, at which refinement ends; and the ratio of successive residuals
/// above which a refinement is no improvement.
inline constexpr double kRefinedResidual = 1e-16, kStalledRatio = 0.5;
/// Residual, relative to the right-hand side, that is accepted after a refinement without improvement.
inline constexpr double kRoundingResidual = 1e-13;

}  // namespace detail

PLIANT_INLINE AugmentedFactor::AugmentedFactor(const Model& model, const Island& island)
    : model_(&model), island_(&island), sides_of_(island.parts.size()) {
  for (const int j : island.joints) {
    const JointModel& joint = model.joints()[at(j)];
    for (std::size_t s = 0; s < joint.sides.size(); ++s)
      sides_of_[at(joint.sides[s].place)].emplace_back(j, static_cast<int>(s));
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t p = 0; p < island.parts.size(); ++p) {
    const int first = island.first[p], n = model.parts()[at(island.parts[p])].n_x();
    for (int i = 0; i < n; ++i) {
      for (int k = i; k < n; ++k) entries.emplace_back(first + k, first + i, 1.0);
      for (const auto& [j, side] : sides_of_[p])
        for (int r = 0; r < model.joints()[at(j)].rows; ++r)
          entries.emplace_back(island.n_v + model.joints()[at(j)].island_row + r, first + i, 1.0);
    }
  }
  for (int r = 0; r < island.rows; ++r) entries.emplace_back(island.n_v + r, island.n_v + r, -1.0);
  K_.resize(island.n_v + island.rows, island.n_v + island.rows);
  K_.setFromTriplets(entries.begin(), entries.end());
  K_.makeCompressed();
  factor_ = model.body().joint_solver.make_factor();
  factor_->analyse(K_, island.n_v);
}

PLIANT_INLINE void AugmentedFactor::factor(const std::vector<PartWorkspace<double>>& parts,
                                           const ConstraintWorkspace<double>& work, bool closed_only) {
  double* value = K_.valuePtr();  // values are in the order of the entries in the constructor
  for (std::size_t p = 0; p < island_->parts.size(); ++p) {
    const PartWorkspace<double>& w = parts[at(island_->parts[p])];
    const MatX<double>& M = w.M();
    const int n = static_cast<int>(M.rows());
    for (int i = 0; i < n; ++i) {
      const bool without_inertia = w.without_inertia(i);
      for (int k = i; k < n; ++k) {
        const bool any_without_inertia = without_inertia || w.without_inertia(k);
        *value++ = any_without_inertia ? (k == i ? 1 : 0) : M(k, i);
      }
      for (const auto& [j, side] : sides_of_[p]) {
        const JointModel& joint = model_->joints()[at(j)];
        const double* Cq = work.Cq.data() + joint.sides[at(side)].offset;
        const bool on = is_selected(work.modes[at(j)], closed_only) && !without_inertia;
        for (int r = 0; r < joint.rows; ++r) *value++ = on ? Cq[r * n + i] : 0;
      }
    }
  }
  std::vector<double> d(at(island_->rows), 1.0);
  for (const int j : island_->joints) {
    const JointModel& joint = model_->joints()[at(j)];
    if (!is_selected(work.modes[at(j)], closed_only)) continue;
    for (int r = 0; r < joint.rows; ++r) {
      const double diagonal = diagonal_of_ends(*model_, work, j, r);
      if (diagonal > 0) d[at(joint.island_row + r)] = detail::kRegularisation * diagonal;
    }
  }
  for (const double d_row : d) *value++ = -d_row;
  factored_ = factor_->factor(K_);  // if the factorisation fails, solve() returns NaN
}

PLIANT_INLINE void AugmentedFactor::solve(VecX<double>& x) const {
  const Eigen::Index n_v = island_->n_v, rows = island_->rows;
  VecX<double> b = VecX<double>::Zero(n_v + rows), z = b, left;
  b.tail(rows) = x;
  if (!factored_ || !x.allFinite()) {  // the check of the state after the step reports NaN
    x.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  double before = std::numeric_limits<double>::infinity();
  left = b;
  int stalled = 0;
  VecX<double> more;
  for (int i = 0; i <= detail::kMaxRefinements; ++i) {
    more = left;
    factor_->solve(more);
    z += more;
    // Compute the residual of Eq. (14), in which d is zero.
    left = b - K_.selfadjointView<Eigen::Lower>() * z;
    left.tail(rows) += K_.diagonal().tail(rows).cwiseProduct(z.tail(rows));
    const double now = left.tail(rows).lpNorm<Eigen::Infinity>();
    const double size = b.lpNorm<Eigen::Infinity>();
    if (!(now > detail::kRefinedResidual * size)) break;
    stalled = now > detail::kStalledRatio * before ? stalled + 1 : 0;
    if (stalled > 0 && now <= detail::kRoundingResidual * size) break;
    if (stalled == detail::kMaxStalledRefinements) {
      // The residual is on rows that depend on other rows and contradict them, for instance while joints are
      // slightly open within a step. Each refinement has added about the same increment to the forces of
      // these rows: remove all i + 1 increments.
      z -= (i + 1) * more;
      break;
    }
    before = now;
  }
  x = -z.tail(rows);
}

PLIANT_INLINE std::vector<bool> dependent_rows(const Model& model, const Island& island,
                                               const ConstraintWorkspace<double>& work) {
  if (island.rows > kMaxRankRows) return std::vector<bool>(at(island.rows), false);
  std::vector<Eigen::Triplet<double>> entries;  // C_q^T with columns of unit length
  for (const int j : island.joints) {
    const JointModel& joint = model.joints()[at(j)];
    if (!acts(work.modes[at(j)])) continue;
    for (int r = 0; r < joint.rows; ++r) {
      double square = 0, threshold = 0;
      for (const JointSide& side : joint.sides) {
        const int n = model.parts()[at(side.part)].n_x();
        const auto Cq = work.Cq.segment(side.offset + r * n, n);
        square += Cq.squaredNorm();
        if (joint.first_offset < 0) continue;
        const auto first = work.Cq.segment(joint.first_offset + r * n, n);
        threshold = detail::kDependentRow * detail::kDependentRow *
                    (first.squaredNorm() + (Cq - first).squaredNorm());
      }
      if (!(square > threshold)) continue;
      for (const JointSide& side : joint.sides) {
        const int n = model.parts()[at(side.part)].n_x(), first = island.first[at(side.place)];
        for (int i = 0; i < n; ++i)
          entries.emplace_back(first + i, joint.island_row + r,
                               work.Cq[side.offset + r * n + i] / std::sqrt(square));
      }
    }
  }
  SparseMatrix A(island.n_v, island.rows);
  A.setFromTriplets(entries.begin(), entries.end());
  A.makeCompressed();
  Eigen::SparseQR<SparseMatrix, Eigen::COLAMDOrdering<int>> qr;
  qr.setPivotThreshold(detail::kDependentRow);
  qr.compute(A);
  std::vector<bool> dependent(at(island.rows), false);
  for (Eigen::Index k = qr.rank(); k < A.cols(); ++k) dependent[at(qr.colsPermutation().indices()[k])] = true;
  return dependent;
}

}  // namespace pliant
