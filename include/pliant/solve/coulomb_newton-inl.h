// Newton's method for Coulomb's law at all contacts of a cluster, in the form of Alart and Curnier (1991):
//   p_n = (p_n - r u_n)+,   p_t = the point of the disc of radius mu (p_n - r u_n)+ nearest to p_t - r u_t.
// Here (...)+ is the positive part, and r > 0 is the inverse of the largest diagonal entry of W of the
// contact. The law of each contact with (p_n - r u_n)+ > 0 is linearised, with the violation F and the
// derivatives T and D of F by u and p:
//   F + T du + D dp = 0.
// The sides S (J_k in coulomb_system.h) give du = S dx, and the pushes Y give dx = sum Y dp over all
// contacts. The velocities of the movers therefore change by
//   (1 + sum Y D^-1 T S) dx = -sum Y D^-1 F.
// The unknowns are velocities and not impulses, because each mover is coupled to few others, often by more
// contact rows than it has velocities.
#pragma once

#include <algorithm>
#include <limits>

#include <Eigen/LU>

#include <pliant/math/header_only.h>
#include <pliant/solve/coulomb_cluster.h>

namespace pliant {

namespace detail {
/// Maximum number of steps; the second value is for warm starts, which converge in fewer steps or not at all.
inline constexpr int kMaxContactNewton = 30, kMaxContactNewtonNear = 10;
/// Maximum size of the factor in a large cluster, in multiples of the size of the diagonal blocks of the
/// movers. Above this size (many bodies packed closely on all sides), sweeps need less time and memory.
inline constexpr double kMaxContactFill = 10;
/// Newton's method reduces the residual to this fraction of exact_level(), for which one more step is usually
/// enough. The second value is for warm starts, so that residuals do not accumulate from time step to time
/// step. For the same reason, the search from a warm start ends only at rounding, exact_level(true), even if
/// the tolerance is larger. Bodies at rest then stay at rest.
inline constexpr double kContactNewtonExact = 0.1, kContactNewtonExactNear = 0.01;
/// Weight of the proximal term, which keeps linearly dependent impulses near their present values. In each
/// step it is multiplied by kProximalFactor, from kFirstProximal (kProximalNear for warm starts) down to
/// kMinProximal, below which rounding outweighs the gain. The values ...OfPointMasses are for clusters with
/// point masses.
inline constexpr double kFirstProximal = 0.003, kProximalFactor = 0.3, kMinProximal = 3e-8,
                        kProximalNear = 1e-5;
inline constexpr double kProximalFactorOfPointMasses = 0.7, kMinProximalOfPointMasses = 1e-5;
/// After kMaxFutileNewton steps without progress, a residual above kFutileFarOff times the best one resets
/// the impulses to the best ones. A step that is not finite resets them at once. The proximal weight is then
/// multiplied by kProximalGrowth, up to kFirstProximal, and does not fall below this value again. If the best
/// residual is at most kAcceptableResidual and the weight is at its minimum, these steps without progress end
/// the method.
inline constexpr int kMaxFutileNewton = 4;
inline constexpr double kFutileFarOff = 1e3, kProximalGrowth = 10;
/// Maximum number of velocities of one mover in the system. For larger movers, sweeps need less time.
inline constexpr int kMaxMoverVelocities = 1000;

/// Adds Y T S to a block, for a push Y and a side S of N velocities each.
template <int N>
void add_contact_product(const double* Y, const Eigen::Matrix3Xd& TS, const MoverSystem::Block& block,
                         MoverSystem& movers) {
  movers.add(block, Eigen::Map<const Eigen::Matrix<double, N, 3>>(Y).lazyProduct(
                        Eigen::Map<const Eigen::Matrix<double, 3, N>>(TS.data())));
}

/// Raises the weight of each velocity of a side S to the largest entry of its column of S: the speed of the
/// contact per unit of this velocity. row: row of the first velocity in the system.
inline void raise_weights(const Eigen::Map<const Eigen::Matrix3Xd>& S, int row, MoverSystem& movers) {
  for (int c = 0; c < S.cols(); ++c) movers.raise_weight(row + c, S.col(c).lpNorm<Eigen::Infinity>());
}

}  // namespace detail

/// Linearises the laws of all contacts with p_n - r u_n > 0 about the present impulses. proximal: weight of
/// the proximal term, which is added to the diagonal of D. For all other contacts, and for contacts without
/// pushes, lists the change that sets the impulse to zero. For contacts without friction, lists the change
/// that sets the tangential impulse to zero.
PLIANT_INLINE void CoulombCluster::linearise(double proximal) {
  auto& [open, drop] = scratch_.linear;
  open.clear();
  drop.clear();
  for (int i = 0; i < size_; ++i) {
    const Vec3<double> u = velocity(i);
    const double r = 1 / contact(i).W.diagonal().maxCoeff(), ahead = p(i)[0] - r * u[0],
                 radius = contact(i).mu * ahead;
    if (is_fixed(i) || !(ahead > 0)) {
      drop.push_back({i, -p(i)});
      continue;
    }
    LinearContactLaw law;
    law.contact = i;
    law.u = u;
    law.T = r * Mat3<double>::Identity();
    law.D = proximal * Mat3<double>::Identity();
    law.F = r * u;
    const Eigen::Vector2d pull = p(i).tail<2>() - r * u.tail<2>();
    if (contact(i).rows == 1 || radius == 0) {  // a normal impulse without friction
      drop.push_back({i, {0, -p(i)[1], -p(i)[2]}});
      law.T.bottomRows<2>().setZero();
      law.F.tail<2>().setZero();
    } else if (pull.norm() > radius) {
      const Eigen::Vector2d e = pull.normalized();
      const Eigen::Matrix2d tangential =
          radius / pull.norm() * (Eigen::Matrix2d::Identity() - e * e.transpose());
      law.T.block<2, 1>(1, 0) = r * contact(i).mu * e;
      law.T.block<2, 2>(1, 1) = r * tangential;
      law.D.block<2, 1>(1, 0) = -contact(i).mu * e;
      law.D.block<2, 2>(1, 1) += Eigen::Matrix2d::Identity() - tangential;
      law.F.tail<2>() = p(i).tail<2>() - radius * e;
    }
    if (compliance_ > 0) law.D += compliance_ * law.T * contact(i).W.diagonal().asDiagonal();
    open.push_back(law);
  }
}

/// Computes the changes dp of the impulses of the linearised contacts: assembles and solves the system for
/// dx.
PLIANT_INLINE void CoulombCluster::solve_linear(MoverSystem& movers) {
  const MoverCoupling& coupling = scratch_.coupling;
  Eigen::Matrix3Xd& TS = scratch_.TS;
  const double* numbers = system_.numbers_.data();
  using Y = Eigen::Map<const MatX<double>>;
  movers.clear();
  for (LinearContactLaw& law : scratch_.linear.open) {
    const Contact& contact_at = contact(law.contact);
    const Mat3<double> inverse = law.D.inverse();
    law.F = (inverse * law.F).eval();
    law.T = (inverse * law.T).eval();
    for (int r = contact_at.first_push; r < contact_at.last_push; ++r) {
      const CoulombSystem::Term& push = system_.used_pushes_[at(r)];
      movers.add(coupling.push_rows[at(r)], Y(numbers + push.numbers, push.size, 3).lazyProduct(-law.F));
    }
    const MoverSystem::Block* block =
        coupling.blocks.data() + coupling.first_block[at(contacts_[law.contact])];
    for (int s = contact_at.first_side; s < contact_at.last_side; ++s) {
      if (coupling.side_rows[at(s)] < 0) continue;
      const CoulombSystem::Term& side = system_.used_sides_[at(s)];
      const Eigen::Map<const Eigen::Matrix3Xd> S(numbers + side.numbers, 3, side.size);
      TS = law.T.lazyProduct(S);
      for (int r = contact_at.first_push; r < contact_at.last_push; ++r, ++block) {
        const CoulombSystem::Term& push = system_.used_pushes_[at(r)];
        if (side.size == 3 && push.size == 3)
          detail::add_contact_product<3>(numbers + push.numbers, TS, *block, movers);
        else if (side.size == 6 && push.size == 6)
          detail::add_contact_product<6>(numbers + push.numbers, TS, *block, movers);
        else
          movers.add(*block, Y(numbers + push.numbers, push.size, 3).lazyProduct(TS));
      }
    }
  }
  movers.solve();
  for (LinearContactLaw& law : scratch_.linear.open) {
    const Contact& contact_at = contact(law.contact);
    Vec3<double> du = Vec3<double>::Zero();
    for (int s = contact_at.first_side; s < contact_at.last_side; ++s) {
      const int row = coupling.side_rows[at(s)];
      if (row < 0) continue;
      const CoulombSystem::Term& side = system_.used_sides_[at(s)];
      const Eigen::Map<const Eigen::Matrix3Xd> S(numbers + side.numbers, 3, side.size);
      du += S.lazyProduct(movers.change(row, side.size));
    }
    law.dp = -law.F - law.T * du;
  }
}

/// Returns the linear system of the cluster, or nullptr if it would be too large. Its pattern is computed
/// once: a contact couples each mover that it pushes with each mover at its sides.
PLIANT_INLINE MoverSystem* CoulombCluster::couple_movers() {
  MoverCoupling& coupling = scratch_.coupling;
  if (coupling.clusters.empty()) {
    coupling.clusters.resize(system_.clusters_.size() - 1);
    coupling.numbers.resize(at(system_.movers()), -1);
    coupling.push_rows.resize(system_.used_pushes_.size(), -1);
    coupling.side_rows.resize(system_.used_sides_.size(), -1);
    coupling.first_block.resize(system_.contacts_.size(), 0);
  }
  MoverSystem& movers = coupling.clusters[at(number_)];
  if (!movers.empty()) return movers.is_ordered() ? &movers : nullptr;
  bool too_large = false;
  for (int i = 0; i < size_; ++i)
    for (int r = contact(i).first_push; r < contact(i).last_push; ++r) {
      const int mover = system_.used_pushes_[at(r)].mover;
      int& number = coupling.numbers[at(mover)];
      if (number >= 0) continue;
      const int used = system_.used_movers_[at(mover) + 1] - system_.used_movers_[at(mover)];
      number = movers.add_mover(used);
      too_large = too_large || used > detail::kMaxMoverVelocities;
    }
  if (too_large) return nullptr;
  auto number_at = [&](const CoulombSystem::Term& term) { return coupling.numbers[at(term.mover)]; };
  auto for_each_pair = [&](int i, auto&& act) {
    for (int s = contact(i).first_side; s < contact(i).last_side; ++s) {
      const CoulombSystem::Term& side = system_.used_sides_[at(s)];
      const int column = number_at(side);
      if (column < 0) continue;
      for (int r = contact(i).first_push; r < contact(i).last_push; ++r)
        act(number_at(system_.used_pushes_[at(r)]), column, side);
    }
  };
  for (int i = 0; i < size_; ++i)
    for_each_pair(i, [&](int row, int column, const CoulombSystem::Term&) { movers.couple(row, column); });
  if (!movers.order(size_ > detail::kManyContacts ? detail::kMaxContactFill
                                                  : std::numeric_limits<double>::infinity()))
    return nullptr;
  auto in_mover = [&](const CoulombSystem::Term& term) {
    return term.first - system_.used_movers_[at(term.mover)];
  };
  for (int i = 0; i < size_; ++i) {
    coupling.first_block[at(contacts_[i])] = coupling.blocks.size();
    for_each_pair(i, [&](int row, int column, const CoulombSystem::Term& side) {
      MoverSystem::Block block = movers.block(row, column);
      block.first += at(in_mover(side) * block.stride);
      coupling.blocks.push_back(block);
    });
    for (int r = contact(i).first_push; r < contact(i).last_push; ++r)
      coupling.push_rows[at(r)] = movers.row(number_at(system_.used_pushes_[at(r)]));
    for (int s = contact(i).first_side; s < contact(i).last_side; ++s) {
      const CoulombSystem::Term& side = system_.used_sides_[at(s)];
      const int number = number_at(side);
      if (number < 0) continue;
      coupling.side_rows[at(s)] = movers.row(number) + in_mover(side);
      detail::raise_weights({system_.numbers_.data() + side.numbers, 3, side.size}, coupling.side_rows[at(s)],
                            movers);
    }
  }
  return &movers;
}

/// Runs Newton's method. Sets the best impulses found; returns whether they are exact (exact_level()).
/// Returns false at once if the linear system is too large. near: whether the method starts from a warm
/// start.
PLIANT_INLINE bool CoulombCluster::newton(bool near) {
  const double beyond = near ? detail::kContactNewtonExactNear : detail::kContactNewtonExact;
  double exact = exact_level(near);
  double best_error = residual();
  if (best_error <= beyond * exact) return true;
  MoverSystem* movers = couple_movers();
  if (movers == nullptr) return false;
  auto& [open, drop] = scratch_.linear;
  VecX<double>& best = scratch_.best;
  copy_impulses(best);
  double proximal = near ? detail::kProximalNear : detail::kFirstProximal,
         min_proximal = has_point_masses_ ? detail::kMinProximalOfPointMasses : detail::kMinProximal;
  const double factor = has_point_masses_ ? detail::kProximalFactorOfPointMasses : detail::kProximalFactor;
  int futile = 0;
  for (int step = 0; step < (near ? detail::kMaxContactNewtonNear : detail::kMaxContactNewton) &&
                     best_error > beyond * exact;
       ++step) {
    linearise(proximal);
    for (const auto& [i, dp] : drop) add_impulse(i, dp);
    for (LinearContactLaw& law : open) law.F += law.T * (velocity(law.contact) - law.u);
    solve_linear(*movers);
    const bool finite =
        std::all_of(open.begin(), open.end(), [](const LinearContactLaw& law) { return law.dp.allFinite(); });
    double error = std::numeric_limits<double>::infinity();
    if (finite) {
      for (const LinearContactLaw& law : open) add_impulse(law.contact, law.dp);
      error = residual();
    }
    if (error < best_error) {
      copy_impulses(best);
      best_error = error;
      exact = exact_level(near);
      futile = 0;
    } else if (best_error <= exact) {
      break;
    } else if (++futile; futile >= detail::kMaxFutileNewton &&
                         best_error <= detail::kAcceptableResidual * scale_ && proximal <= min_proximal) {
      break;
    } else if (!finite ||
               (futile >= detail::kMaxFutileNewton && error > detail::kFutileFarOff * best_error)) {
      futile = 0;
      set_impulses(best);
      proximal = min_proximal = std::min(detail::kFirstProximal, detail::kProximalGrowth * proximal);
      continue;
    }
    proximal = std::max(factor * proximal, min_proximal);
  }
  set_impulses(best);
  return residual() <= exact_level();
}

}  // namespace pliant
