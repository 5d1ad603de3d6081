#include "coulomb_cluster.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Cholesky>

namespace pliant {

namespace {

/// Sweeps end when impulses change velocities by less than this, relative to what there is to stop; or by so
/// many units of rounding of the velocities themselves.
constexpr double kExact = 1e-13, kUlps = 8;
/// The same where points are pushed, many at a time and lightly coupled.
constexpr double kExactOfPoints = 1e-6;
/// Rounds of so many sweeps, which are extrapolated from so many before them.
constexpr std::array<std::pair<int, int>, 4> kRounds{{{12, 4}, {120, 8}, {400, 0}, {200, 8}}};
constexpr std::array<std::pair<int, int>, 3> kRoundsOfPoints{{{12, 4}, {120, 0}, {120, 8}}};
/// Extrapolation starts anew when it has made things worse by this factor.
constexpr double kWorse = 4;
/// Sweeps that depend on each other by more than this are not told apart.
constexpr double kSameSweep = 1e-14;
/// kLeft of many contacts, or of points; and what contacts yield by, as a share of their W.
constexpr double kLeftOfMany = 1e-2, kYielding = 1e-4;
/// Impulses that stay bounded may leave this many times what others leave.
constexpr double kBounded = 2;
/// A search has stalled where a round leaves more than this share of what the one before left: contacts that
/// hardly differ may leave what no impulse in reason takes off.
constexpr double kStalledShare = 0.1;
/// A search goes on from impulses that leave less than this share of what there is to stop.
constexpr double kNear = 0.1;

}  // namespace

CoulombCluster::CoulombCluster(CoulombSystem& system, int number, double enough, CoulombScratch& scratch)
    : system_(system),
      number_(number),
      contacts_(system.order_.data() + system.clusters_[at(number)]),
      size_(system.clusters_[at(number) + 1] - system.clusters_[at(number)]),
      enough_(enough),
      scratch_(scratch) {
  for (int i = 0; i < size_; ++i)
    for (int s = point(i).first_side; s < point(i).last_side; ++s)
      points_ = points_ || system_.mover_size(system_.seen_sides_[at(s)].mover) == 3;
}

/// Velocities that count as zero, and those that may be left.
void CoulombCluster::set_scale() {
  double terms = 0;
  scale_ = 0;
  for (int i = 0; i < size_; ++i) {
    scale_ = std::max(scale_, velocity(i).lpNorm<Eigen::Infinity>());
    for (int s = point(i).first_side; s < point(i).last_side; ++s) {
      const CoulombSystem::Term& side = system_.seen_sides_[at(s)];
      const Eigen::Map<const Eigen::Matrix3Xd> J(system_.numbers_.data() + side.numbers, 3, side.size);
      terms = std::max(terms, J.lpNorm<Eigen::Infinity>() *
                                  system_.x_.segment(side.first, side.size).lpNorm<Eigen::Infinity>());
    }
  }
  exact_ = std::max({(points_ ? kExactOfPoints : kExact) * scale_,
                     kUlps * std::numeric_limits<double>::epsilon() * terms, enough_});
  allowed_ = std::max(exact_, (points_ || size_ > kMany ? kLeftOfMany : kLeft) * scale_);
}

/// Contacts give way by this share of W.
void CoulombCluster::yield(double softness) {
  softness_ = softness;
  for (int i = 0; i < size_; ++i) {
    Mat3<double> W = point(i).W;
    W.diagonal() *= 1 + softness;
    point(i).law = CoulombLaw(W, point(i).rows == 1 ? 0 : point(i).mu);
  }
}

Vec3<double> CoulombCluster::velocity(int i) const {
  Vec3<double> u = system_.velocity_at(contacts_[i], system_.seen_sides_, system_.x_);
  if (softness_ > 0) u += softness_ * point(i).W.diagonal().cwiseProduct(p(i));
  return u;
}

/// The impulse that its law asks for when u is the velocity with the impulse it has.
Vec3<double> CoulombCluster::met(int i, const Vec3<double>& u) const {
  const Mat3<double>& W = point(i).W;
  if (point(i).rows == 1) return {std::max(0.0, p(i)[0] - u[0] / ((1 + softness_) * W(0, 0))), 0, 0};
  Vec3<double> b = u - W * p(i);
  if (softness_ > 0) b -= softness_ * W.diagonal().cwiseProduct(p(i));
  return point(i).law.push(b);
}

/// Changes an impulse and what it moves.
void CoulombCluster::push(int i, const Vec3<double>& dp) {
  p(i) += dp;
  for (int r = point(i).first_push; r < point(i).last_push; ++r) {
    const CoulombSystem::Term& term = system_.seen_pushes_[at(r)];
    const double* Y = system_.numbers_.data() + term.numbers;
    if (term.size == 3)
      system_.x_.segment<3>(term.first).noalias() += Eigen::Map<const Mat3<double>>(Y) * dp;
    else if (term.size == 6)
      system_.x_.segment<6>(term.first).noalias() += Eigen::Map<const Eigen::Matrix<double, 6, 3>>(Y) * dp;
    else
      system_.x_.segment(term.first, term.size).noalias() +=
          Eigen::Map<const MatX<double>>(Y, term.size, 3) * dp;
  }
}

/// Velocities that count as zero by the present impulses: these leave rounding of what they push by, which is
/// great where something light holds something heavy.
double CoulombCluster::exact_now() const {
  double most = 0;
  for (int i = 0; i < size_; ++i)
    most = std::max(most, point(i).W.diagonal().maxCoeff() * p(i).lpNorm<Eigen::Infinity>());
  return std::max(exact_, std::min(allowed_, kUlps * std::numeric_limits<double>::epsilon() * most));
}

double CoulombCluster::sweep(bool forward) {
  double change = 0;
  for (int k = 0; k < size_; ++k) {
    const int i = forward ? k : size_ - 1 - k;
    if (is_fixed(i)) continue;
    const Vec3<double> dp = met(i, velocity(i)) - p(i);
    push(i, dp);
    change = std::max(change, (point(i).W * dp).lpNorm<Eigen::Infinity>());
  }
  return change;
}

double CoulombCluster::residual() const {
  double worst = 0;
  for (int i = 0; i < size_; ++i) {
    if (is_fixed(i)) {  // nothing can stop it
      worst = std::max(worst, -velocity(i)[0]);
      continue;
    }
    const Vec3<double> dp = met(i, velocity(i)) - p(i);
    worst = std::max(worst, (point(i).W * dp).lpNorm<Eigen::Infinity>());
  }
  return worst;
}

void CoulombCluster::take(VecX<double>& impulses) const {
  impulses.resize(3 * size_);
  for (int i = 0; i < size_; ++i) impulses.segment<3>(3 * i) = p(i);
}

/// There are no impulses.
void CoulombCluster::reset() {
  for (int i = 0; i < size_; ++i)
    for (int r = point(i).first_push; r < point(i).last_push; ++r) {
      const CoulombSystem::Term& term = system_.seen_pushes_[at(r)];
      system_.x_.segment(term.first, term.size) = system_.x0_.segment(term.first, term.size);
    }
  for (int i = 0; i < size_; ++i) p(i).setZero();
}

/// Velocities are those by these impulses, anew.
void CoulombCluster::set(const VecX<double>& impulses) {
  reset();
  for (int i = 0; i < size_; ++i) push(i, impulses.segment<3>(3 * i));
}

/// Sweeps there and back as a fixed point p = g(p), extrapolated from the last of them to where p - g(p)
/// would be least if g were linear (Anderson 1965), which it is once contacts have settled on whether they
/// slide. Leaves the best it has seen; returns whether that is exact.
bool CoulombCluster::relax(int most, int history, int& sweeps) {
  const Eigen::Index n = 3 * size_;
  auto& [now, next, last, r, last_r, weight, dr, dp] = scratch_.sweeps;
  VecX<double>& best = scratch_.best;
  weight.resize(n);  // impulses as velocities
  for (int i = 0; i < size_; ++i)
    weight.segment<3>(3 * i).setConstant(std::max(point(i).W(0, 0), std::numeric_limits<double>::min()));
  if (dr.rows() < n || dr.cols() < history) {
    dr.resize(std::max(n, dr.rows()), std::max<Eigen::Index>(history, dr.cols()));
    dp.resizeLike(dr);
  }
  constexpr int kMostHistory = 8;
  using Gram = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMostHistory, kMostHistory>;
  Gram G = Gram::Zero(history, history);
  take(now);
  double best_left = std::numeric_limits<double>::infinity();
  int filled = 0, slot = 0;
  bool follows = false;  // whether there is a sweep before, to compare with
  for (int i = 0; i < most; i += 2) {
    sweep(true);
    const double change = sweep(false);
    sweeps += 2;
    take(next);
    r = weight.cwiseProduct(next - now);
    const double left = std::max(change, r.lpNorm<Eigen::Infinity>());
    if (left < best_left) {
      best = next;
      best_left = left;
    }
    if (left <= exact_now()) return true;
    if (history == 0) {
      now.swap(next);
      continue;
    }
    if (!(left <= kWorse * best_left)) {
      filled = slot = 0;
      follows = false;
      now = best;
      set(now);
      continue;
    }
    if (follows) {
      dr.col(slot).head(n) = r - last_r;
      dp.col(slot).head(n) = next - last;
      filled = std::min(filled + 1, history);
      for (int j = 0; j < filled; ++j) G(slot, j) = G(j, slot) = dr.col(slot).head(n).dot(dr.col(j).head(n));
      slot = (slot + 1) % history;
    }
    follows = true;
    last_r = r;
    last = next;
    now = next;
    if (filled > 0) {
      Gram A = G.topLeftCorner(filled, filled);
      A.diagonal() *= 1 + kSameSweep;
      Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMostHistory, 1> gamma(filled);
      for (int j = 0; j < filled; ++j) gamma[j] = dr.col(j).head(n).dot(r);
      gamma = A.ldlt().solve(gamma).eval();
      if (gamma.allFinite())
        for (int j = 0; j < filled; ++j) now -= gamma[j] * dp.col(j).head(n);
    }
    set(now);
  }
  set(best);
  return false;
}

/// Whether searches may begin at impulses: not of one contact, which takes none, nor of points, which are
/// many and lightly coupled.
bool CoulombCluster::may_warm_start() const {
  return size_ > 1 && !points_;
}

/// From impulses that may be near the solution: returns whether it found that, and begins at none otherwise.
bool CoulombCluster::follow(const VecX<double>& begun) {
  set(begun);
  if (begun.allFinite() && residual() <= kNear * scale_ && newton(true)) return true;
  reset();
  return false;
}

/// Returns whether it found the solution.
bool CoulombCluster::search(int& sweeps) {
  // Newton's method is fast near a solution, plain sweeps are slow but sure, extrapolated ones are between.
  const bool many = size_ > kMany;
  const auto* first = points_ ? kRoundsOfPoints.begin() : kRounds.begin();
  const auto* last = points_ ? kRoundsOfPoints.end() : kRounds.end();
  double before = std::numeric_limits<double>::infinity();
  VecX<double> kept;  // what the round before found
  for (const auto* round = first; round != last; ++round) {
    const auto& [most, history] = *round;
    if (many && history == 0) continue;  // it would take too long, as Newton's method would with many points
    if (relax(most, history, sweeps) || (points_ && residual() <= exact_)) return true;
    if (!(many && points_) && newton(false)) return true;
    const double left = residual();
    if (left <= kLeft * scale_ && left > kStalledShare * before) {
      if (left > before) set(kept);
      return false;
    }
    take(kept);
    before = left;
  }
  return false;
}

/// What has no solution, as where joints and contacts contradict each other, or where none is found, is
/// solved with contacts that yield, which has one; the better of the two stays.
void CoulombCluster::solve(CoulombResult& result) {
  yield(0);
  if (size_ == 1) {
    reset();
    set_scale();
    sweep(true);
    ++result.sweeps;
    result.residual = std::max(result.residual, residual());
    return;
  }
  VecX<double> begun, found;
  take(begun);
  const bool begins = may_warm_start() && !begun.isZero(0);
  reset();
  set_scale();
  const bool solved = (begins && follow(begun)) || search(result.sweeps);
  double left = residual();
  if (!solved && left > allowed_) {
    ++result.fallbacks;
    take(found);
    reset();
    yield(kYielding);
    search(result.sweeps);
    yield(0);
    const double yielding = residual();
    if (yielding < kBounded * left)
      left = yielding;
    else
      set(found);
  }
  result.residual = std::max(result.residual, left);
  for (int i = 0; i < size_; ++i) point(i).begins = may_warm_start();
}

}  // namespace pliant
