// Function bodies of coulomb_cluster.h: sweeps with extrapolation, and the sequence of the methods.
#pragma once

#include <pliant/solve/coulomb_cluster.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// Tolerances of the sweeps. The largest of these two tolerances and of the two tolerances of
/// CoulombTolerance is used. kSweepExact is relative to the largest contact velocity without impulses.
/// kSweepUlps is in units of the rounding error of the contact velocities J x.
inline constexpr double kSweepExact = 1e-13, kSweepUlps = 8;
/// This value replaces kSweepExact for clusters with point masses (movers with three velocities, for example
/// nodes of a mesh), unless CoulombTolerance::share is given. Point masses are many and weakly coupled.
inline constexpr double kSweepExactOfPointMasses = 1e-6;
/// Rounds of the search: maximum number of sweeps, and number of pairs of sweeps for the extrapolation (0: no
/// extrapolation). Large clusters (more than kManyContacts contacts) skip the rounds without extrapolation.
inline constexpr std::array<std::pair<int, int>, 4> kSweepRounds{{{12, 4}, {120, 8}, {400, 0}, {200, 8}}};
inline constexpr std::array<std::pair<int, int>, 3> kSweepRoundsOfPointMasses{{{12, 4}, {120, 0}, {120, 8}}};
/// The extrapolation restarts if the residual exceeds this multiple of the smallest residual so far.
inline constexpr double kSweepWorse = 4;
/// Relative regularisation of the extrapolation, in case the results of sweeps are linearly dependent.
inline constexpr double kSweepRegularisation = 1e-14;
/// kAcceptableOfManyContacts replaces kAcceptableResidual in the decision about a second search, for large
/// clusters and clusters with point masses. kContactCompliance is the compliance of contacts in this second
/// search, as a fraction of the diagonal of W.
inline constexpr double kAcceptableOfManyContacts = 1e-2, kContactCompliance = 1e-4;
/// The result of the search with compliant contacts is used if its residual is less than this multiple of the
/// residual of the first search. The factor is above 1 because impulses of compliant contacts are bounded.
inline constexpr double kCompliantPreference = 2;
/// A search stalls if a round leaves more than this fraction of the residual of the round before. A search
/// that stalls ends if its residual is at most kAcceptableResidual, because only unreasonably large impulses
/// would reduce the residual further. Contacts that are nearly equal can cause this.
inline constexpr double kSweepStalled = 0.1;
/// A warm start is used if its residual is at most this fraction of the largest contact velocity without
/// impulses.
inline constexpr double kNearWarmStart = 0.1;

/// Maximum number of pairs of sweeps in the extrapolation, and the matrix of their scalar products.
inline constexpr int kMaxSweepHistory = 8;
using SweepGram =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxSweepHistory, kMaxSweepHistory>;

/// Changes `now` to the impulses for which the linear model of the residual r is smallest. G: scalar products
/// of the columns of dr; filled: number of columns. Changes nothing if the linear system is singular.
inline void extrapolate_sweeps(const SweepGram& G, int filled, CoulombScratch::Sweeps& sweeps) {
  auto& [now, next, last, r, last_r, weight, dr, dp] = sweeps;
  const Eigen::Index n = r.size();
  SweepGram A = G.topLeftCorner(filled, filled);
  A.diagonal() *= 1 + kSweepRegularisation;
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxSweepHistory, 1> gamma(filled);
  for (int j = 0; j < filled; ++j) gamma[j] = dr.col(j).head(n).dot(r);
  gamma = A.ldlt().solve(gamma).eval();
  if (gamma.allFinite())
    for (int j = 0; j < filled; ++j) now -= gamma[j] * dp.col(j).head(n);
}

}  // namespace detail

PLIANT_INLINE CoulombCluster::CoulombCluster(CoulombSystem& system, int number,
                                             const CoulombTolerance& tolerance, CoulombScratch& scratch)
    : system_(system),
      number_(number),
      contacts_(system.order_.data() + system.clusters_[at(number)]),
      size_(system.clusters_[at(number) + 1] - system.clusters_[at(number)]),
      tolerance_(tolerance),
      scratch_(scratch) {
  for (int i = 0; i < size_; ++i) {
    has_limits_ = has_limits_ || contact(i).is_limit;
    for (int s = contact(i).first_side; s < contact(i).last_side; ++s)
      has_point_masses_ = has_point_masses_ || system_.mover_size(system_.used_sides_[at(s)].mover) == 3;
  }
}

/// Computes scale_, approach_, rounding_, exact_ and acceptable_. The present velocities must be those
/// without impulses.
PLIANT_INLINE void CoulombCluster::set_scale() {
  double terms = 0;
  scale_ = approach_ = 0;
  for (int i = 0; i < size_; ++i) {
    const Vec3<double> u = velocity(i);
    scale_ = std::max(scale_, u.lpNorm<Eigen::Infinity>());
    if (!contact(i).is_limit) approach_ = std::max(approach_, -u[0]);
    for (int s = contact(i).first_side; s < contact(i).last_side; ++s) {
      const CoulombSystem::Term& side = system_.used_sides_[at(s)];
      const Eigen::Map<const Eigen::Matrix3Xd> J(system_.numbers_.data() + side.numbers, 3, side.size);
      const auto x = system_.x_.segment(side.first, side.size);
      terms = std::max(terms, (J.cwiseAbs() * x.cwiseAbs()).maxCoeff());
    }
  }
  const bool rough = has_point_masses_ && !tolerance_.share;
  rounding_ =
      std::max({(rough ? detail::kSweepExactOfPointMasses : detail::kSweepExact) * scale_,
                detail::kSweepUlps * std::numeric_limits<double>::epsilon() * terms, tolerance_.velocity});
  exact_ = std::max(rounding_, tolerance_.share.value_or(0) * approach_);
  acceptable_ =
      std::max(exact_, (has_point_masses_ || size_ > detail::kManyContacts ? detail::kAcceptableOfManyContacts
                                                                           : detail::kAcceptableResidual) *
                           scale_);
}

/// Sets the compliance of all contacts, as a fraction of the diagonal of W.
PLIANT_INLINE void CoulombCluster::set_compliance(double compliance) {
  compliance_ = compliance;
  for (int i = 0; i < size_; ++i) {
    Mat3<double> W = contact(i).W;
    W.diagonal() *= 1 + compliance;
    contact(i).law = CoulombLaw(W, contact(i).rows == 1 ? 0 : contact(i).mu);
  }
}

/// Returns the velocity u of contact i, plus its compliance times its impulse.
PLIANT_INLINE Vec3<double> CoulombCluster::velocity(int i) const {
  Vec3<double> u = system_.velocity_at(contacts_[i], system_.used_sides_, system_.x_);
  if (compliance_ > 0) u += compliance_ * contact(i).W.diagonal().cwiseProduct(p(i));
  return u;
}

/// Returns the impulse that satisfies the law of contact i alone. u: the velocity with its present impulse.
PLIANT_INLINE Vec3<double> CoulombCluster::law_impulse(int i, const Vec3<double>& u) const {
  const Mat3<double>& W = contact(i).W;
  if (contact(i).rows == 1) return {std::max(0.0, p(i)[0] - u[0] / ((1 + compliance_) * W(0, 0))), 0, 0};
  Vec3<double> b = u - W * p(i);
  if (compliance_ > 0) b -= compliance_ * W.diagonal().cwiseProduct(p(i));
  return contact(i).law.impulse(b);
}

/// Adds dp to the impulse of contact i and updates the velocities of the movers.
PLIANT_INLINE void CoulombCluster::add_impulse(int i, const Vec3<double>& dp) {
  p(i) += dp;
  system_.add_change_to(contacts_[i], dp, system_.used_pushes_, system_.x_);
}

/// Returns the residual at which the search ends: exact_, or rounding_ if to_rounding is true. If the
/// rounding error of the present impulses, as a velocity, is larger, this error is returned, but at most
/// acceptable_. This rounding error is large where a light part supports a heavy one.
PLIANT_INLINE double CoulombCluster::exact_level(bool to_rounding) const {
  double largest = 0;
  for (int i = 0; i < size_; ++i)
    largest = std::max(largest, contact(i).W.diagonal().maxCoeff() * p(i).lpNorm<Eigen::Infinity>());
  return std::max(
      to_rounding ? rounding_ : exact_,
      std::min(acceptable_, detail::kSweepUlps * std::numeric_limits<double>::epsilon() * largest));
}

/// Solves the law of each contact once, in ascending (forward) or descending order. Returns the largest
/// change |W dp| of the velocity of a contact by the change dp of its own impulse.
PLIANT_INLINE double CoulombCluster::sweep(bool forward) {
  double change = 0;
  for (int k = 0; k < size_; ++k) {
    const int i = forward ? k : size_ - 1 - k;
    if (is_fixed(i)) continue;
    const Vec3<double> dp = law_impulse(i, velocity(i)) - p(i);
    add_impulse(i, dp);
    change = std::max(change, (contact(i).W * dp).lpNorm<Eigen::Infinity>());
  }
  return change;
}

/// Returns the weight of a violation of the law of contact i. accepted: the accepted violation of contacts.
/// At a limit of a parameter, `share` times the change of speed by the impulse p is accepted instead, and the
/// weight is the ratio of both accepted values. At other contacts the weight is 1.
PLIANT_INLINE double CoulombCluster::weight_of(int i, double p, double share, double accepted) const {
  if (!contact(i).is_limit) return 1;
  return accepted / std::max(rounding_, share * contact(i).W(0, 0) * p);
}

/// Returns the largest violation of the law, as a velocity |W dp|. dp is the change to the impulse that
/// satisfies the law of its contact alone. share, accepted: see weight_of().
PLIANT_INLINE double CoulombCluster::residual(double share, double accepted) const {
  double worst = 0;
  for (int i = 0; i < size_; ++i) {
    if (is_fixed(i)) {  // no impulse can change this velocity
      worst = std::max(worst, -velocity(i)[0]);
      continue;
    }
    const Vec3<double> q = law_impulse(i, velocity(i)), dp = q - p(i);
    worst = std::max(worst, weight_of(i, std::max(q[0], p(i)[0]), share, accepted) *
                                (contact(i).W * dp).lpNorm<Eigen::Infinity>());
  }
  return worst;
}

/// Copies the present impulses, 3 for each contact.
PLIANT_INLINE void CoulombCluster::copy_impulses(VecX<double>& impulses) const {
  impulses.resize(3 * size_);
  for (int i = 0; i < size_; ++i) impulses.segment<3>(3 * i) = p(i);
}

/// Sets all impulses to zero, and the velocities to those without impulses.
PLIANT_INLINE void CoulombCluster::clear_impulses() {
  for (int i = 0; i < size_; ++i)
    for (int r = contact(i).first_push; r < contact(i).last_push; ++r) {
      const CoulombSystem::Term& term = system_.used_pushes_[at(r)];
      system_.x_.segment(term.first, term.size) = system_.x0_.segment(term.first, term.size);
    }
  for (int i = 0; i < size_; ++i) p(i).setZero();
}

/// Sets the impulses, and recomputes the velocities from them.
PLIANT_INLINE void CoulombCluster::set_impulses(const VecX<double>& impulses) {
  clear_impulses();
  for (int i = 0; i < size_; ++i) add_impulse(i, impulses.segment<3>(3 * i));
}

/// Runs pairs of sweeps (forward, backward) as a fixed-point iteration p = g(p) with Anderson acceleration
/// (1965): the next p minimises |p - g(p)| over combinations of the last `history` pairs, as if g were
/// linear. history = 0: no acceleration. g is piecewise smooth, and linear while all contacts stick or
/// separate. Sets the best impulses found; adds the number of sweeps to `sweeps`. Returns whether the
/// impulses are exact (exact_level()).
PLIANT_INLINE bool CoulombCluster::accelerated_sweeps(int max_sweeps, int history, int& sweeps) {
  const Eigen::Index n = 3 * size_;
  auto& [now, next, last, r, last_r, weight, dr, dp] = scratch_.sweeps;
  VecX<double>& best = scratch_.best;
  weight.resize(n);  // scale of each impulse to a velocity
  for (int i = 0; i < size_; ++i)
    weight.segment<3>(3 * i).setConstant(std::max(contact(i).W(0, 0), std::numeric_limits<double>::min()));
  if (dr.rows() < n || dr.cols() < history) {
    dr.resize(std::max(n, dr.rows()), std::max<Eigen::Index>(history, dr.cols()));
    dp.resizeLike(dr);
  }
  detail::SweepGram G = detail::SweepGram::Zero(history, history);
  copy_impulses(now);
  double best_error = std::numeric_limits<double>::infinity();
  int filled = 0, slot = 0;
  bool has_pair_before = false;  // whether last and last_r contain the previous pair
  for (int i = 0; i < max_sweeps; i += 2) {
    sweep(true);
    const double change = sweep(false);
    sweeps += 2;
    copy_impulses(next);
    r = weight.cwiseProduct(next - now);
    const double error = std::max(change, r.lpNorm<Eigen::Infinity>());
    if (error < best_error) {
      best = next;
      best_error = error;
    }
    if (error <= exact_level() && (!tolerance_.share || residual() <= exact_level())) return true;
    if (history == 0) {
      now.swap(next);
      continue;
    }
    if (!(error <= detail::kSweepWorse * best_error)) {
      filled = slot = 0;
      has_pair_before = false;
      now = best;
      set_impulses(now);
      continue;
    }
    if (has_pair_before) {
      dr.col(slot).head(n) = r - last_r;
      dp.col(slot).head(n) = next - last;
      filled = std::min(filled + 1, history);
      for (int j = 0; j < filled; ++j) G(slot, j) = G(j, slot) = dr.col(slot).head(n).dot(dr.col(j).head(n));
      slot = (slot + 1) % history;
    }
    has_pair_before = true;
    last_r = r;
    last = next;
    now = next;
    if (filled > 0) detail::extrapolate_sweeps(G, filled, scratch_.sweeps);
    set_impulses(now);
  }
  set_impulses(best);
  return false;
}

/// Returns whether the cluster uses warm starts. A single contact is solved directly. Clusters with point
/// masses need no warm start, because point masses are weakly coupled.
PLIANT_INLINE bool CoulombCluster::may_warm_start() const {
  return size_ > 1 && !has_point_masses_;
}

/// Tries Newton's method from a warm start, the impulses `initial`. Returns whether the solution was found;
/// if not, clears all impulses.
PLIANT_INLINE bool CoulombCluster::try_warm_start(const VecX<double>& initial) {
  set_impulses(initial);
  if (initial.allFinite() && residual() <= detail::kNearWarmStart * scale_ && newton(true)) return true;
  clear_impulses();
  return false;
}

/// Runs the rounds of sweeps until the solution is found, the search stalls or all rounds are done. Newton's
/// method follows each round, except in clusters with point masses and many contacts. Returns whether the
/// solution was found.
PLIANT_INLINE bool CoulombCluster::search(int& sweeps) {
  // Newton's method is fast near a solution; plain sweeps are slow but robust; extrapolated sweeps are in
  // between.
  const bool many = size_ > detail::kManyContacts;
  const auto* first =
      has_point_masses_ ? detail::kSweepRoundsOfPointMasses.begin() : detail::kSweepRounds.begin();
  const auto* last = has_point_masses_ ? detail::kSweepRoundsOfPointMasses.end() : detail::kSweepRounds.end();
  double before = std::numeric_limits<double>::infinity();
  VecX<double> previous;  // the impulses of the previous round
  for (const auto* round = first; round != last; ++round) {
    const auto& [max_sweeps, history] = *round;
    if (many && history == 0) continue;  // too slow for many contacts
    if (accelerated_sweeps(max_sweeps, history, sweeps) || (has_point_masses_ && residual() <= exact_))
      return true;
    if (!(many && has_point_masses_) && newton(false)) return true;
    const double error = residual();
    if (error <= detail::kAcceptableResidual * scale_ && error > detail::kSweepStalled * before) {
      if (error > before) set_impulses(previous);
      return false;
    }
    copy_impulses(previous);
    before = error;
  }
  return false;
}

/// Updates the residuals in the result with the residual of this cluster.
PLIANT_INLINE void CoulombCluster::record(double residual, CoulombResult& result) const {
  result.residual = std::max(result.residual, residual);
  const double share = tolerance_.share.value_or(detail::kReportedShare),
               accepted = std::max(exact_level(), share * approach_);
  // Without limits all weights (weight_of) are 1.
  const double reported = has_limits_ ? this->residual(share, accepted) : residual;
  if (!(reported * result.worst_accepted >= result.worst_residual * accepted) || !(reported > 0)) return;
  result.worst_residual = reported;
  result.worst_accepted = accepted;
}

/// Solves the cluster: a single contact directly, others from a warm start or by search(). If the search
/// fails, for instance because joints and contacts contradict each other, it is repeated with compliant
/// contacts, for which a solution exists. kCompliantPreference decides between the two results.
PLIANT_INLINE void CoulombCluster::solve(CoulombResult& result) {
  set_compliance(0);
  if (size_ == 1) {
    clear_impulses();
    set_scale();
    sweep(true);
    ++result.sweeps;
    return record(residual(), result);
  }
  VecX<double> initial, found;
  copy_impulses(initial);
  const bool warm_start = may_warm_start() && !initial.isZero(0);
  clear_impulses();
  set_scale();
  const bool solved = (warm_start && try_warm_start(initial)) || search(result.sweeps);
  double error = residual();
  if (!solved && error > acceptable_) {
    ++result.fallbacks;
    copy_impulses(found);
    clear_impulses();
    set_compliance(detail::kContactCompliance);
    search(result.sweeps);
    set_compliance(0);
    const double compliant = residual();
    if (compliant < detail::kCompliantPreference * error)
      error = compliant;
    else
      set_impulses(found);
  }
  record(error, result);
  for (int i = 0; i < size_; ++i) contact(i).warm_start = may_warm_start();
}

}  // namespace pliant
