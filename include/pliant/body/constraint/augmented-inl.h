#include <pliant/body/constraint/augmented.h>

#include <cmath>
#include <limits>

#include <Eigen/SparseQR>

#include <pliant/body/dynamics.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// d over the diagonal entry of W_c.
constexpr double kRegular = 1e-9;
/// A row of unit length that is nearer than this to those before it depends on them.
constexpr double kDependent = 3e-5;
/// Refinements, which end when the rows are met to rounding, or when so many of them did not improve.
constexpr int kMostRefinements = 12, kStalled = 3;
constexpr double kMet = 1e-16, kImproves = 0.5;
/// Rows that are met but for this part of them are met as well as rounding lets them be.
constexpr double kRounding = 1e-13;

}  // namespace

AugmentedFactor::AugmentedFactor(const Model& model, const Island& island)
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

void AugmentedFactor::factor(const std::vector<PartWorkspace<double>>& parts,
                             const ConstraintWorkspace<double>& work, bool closed_only) {
  double* value = K_.valuePtr();  // in the order in which the pattern was made
  for (std::size_t p = 0; p < island_->parts.size(); ++p) {
    const PartWorkspace<double>& w = parts[at(island_->parts[p])];
    const int n = static_cast<int>(w.inertia.M.rows());
    for (int i = 0; i < n; ++i) {
      const bool held = w.held(i);
      for (int k = i; k < n; ++k) {
        const bool still = held || w.held(k);
        *value++ = still ? (k == i ? 1 : 0) : w.inertia.M(k, i);
      }
      for (const auto& [j, side] : sides_of_[p]) {
        const JointModel& joint = model_->joints()[at(j)];
        const double* Cq = work.Cq.data() + joint.sides[at(side)].offset;
        const bool on = counts(work.modes[at(j)], closed_only) && !held;
        for (int r = 0; r < joint.rows; ++r) *value++ = on ? Cq[r * n + i] : 0;
      }
    }
  }
  std::vector<double> d(at(island_->rows), 1.0);
  for (const int j : island_->joints) {
    const JointModel& joint = model_->joints()[at(j)];
    if (!counts(work.modes[at(j)], closed_only)) continue;
    for (int r = 0; r < joint.rows; ++r) {
      const double diagonal = entry_of_ends(*model_, work, j, r);
      if (diagonal > 0) d[at(joint.island_row + r)] = kRegular * diagonal;
    }
  }
  for (const double of_row : d) *value++ = -of_row;
  sound_ = factor_->factor(K_);  // what stops it leaves solutions that are no numbers
}

void AugmentedFactor::solve(VecX<double>& x) const {
  const Eigen::Index n_v = island_->n_v, rows = island_->rows;
  VecX<double> b = VecX<double>::Zero(n_v + rows), z = b, left;
  b.tail(rows) = x;
  if (!sound_ || !x.allFinite()) {  // the finite check finds it
    x.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  double before = std::numeric_limits<double>::infinity();
  left = b;
  int stalled = 0;
  VecX<double> more;
  for (int i = 0; i <= kMostRefinements; ++i) {
    more = left;
    factor_->solve(more);
    z += more;
    // What is left without d.
    left = b - K_.selfadjointView<Eigen::Lower>() * z;
    left.tail(rows) += K_.diagonal().tail(rows).cwiseProduct(z.tail(rows));
    const double now = left.tail(rows).lpNorm<Eigen::Infinity>();
    const double size = b.lpNorm<Eigen::Infinity>();
    if (!(now > kMet * size)) break;
    stalled = now > kImproves * before ? stalled + 1 : 0;
    if (stalled > 0 && now <= kRounding * size) break;
    if (stalled == kStalled) {
      // What is left is on rows that depend on others but disagree with them, as where joints are a little
      // open within a step. Each refinement has added the same to their forces: they are to have none.
      z -= (i + 1) * more;
      break;
    }
    before = now;
  }
  x = -z.tail(rows);
}

std::vector<bool> dependent_rows(const Model& model, const Island& island,
                                 const ConstraintWorkspace<double>& work) {
  if (island.rows > kMostForRank) return std::vector<bool>(at(island.rows), false);
  std::vector<Eigen::Triplet<double>> entries;  // of C_q^T, columns of unit length
  for (const int j : island.joints) {
    const JointModel& joint = model.joints()[at(j)];
    if (!acts(work.modes[at(j)])) continue;
    for (int r = 0; r < joint.rows; ++r) {
      double square = 0, least = 0;
      for (const JointSide& side : joint.sides) {
        const int n = model.parts()[at(side.part)].n_x();
        const auto Cq = work.Cq.segment(side.offset + r * n, n);
        square += Cq.squaredNorm();
        if (joint.first_offset < 0) continue;
        const auto first = work.Cq.segment(joint.first_offset + r * n, n);
        least = kDependent * kDependent * (first.squaredNorm() + (Cq - first).squaredNorm());
      }
      if (!(square > least)) continue;
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
  qr.setPivotThreshold(kDependent);
  qr.compute(A);
  std::vector<bool> dependent(at(island.rows), false);
  for (Eigen::Index k = qr.rank(); k < A.cols(); ++k) dependent[at(qr.colsPermutation().indices()[k])] = true;
  return dependent;
}

}  // namespace pliant
