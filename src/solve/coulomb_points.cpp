// Newton's method (solve/coulomb_newton.cpp) where points are pushed, of which contacts couple each to few
// others, often by more rows than they can move. Linear at each contact that pushes,
//   F + T du + D dp = 0,
// and with du = S dx, dx = sum Y dp of all contacts what they push changes by
//   (1 + sum Y D^-1 T S) dx = -sum Y D^-1 F.
#include <algorithm>

#include <Eigen/LU>

#include "coulomb_cluster.h"

namespace pliant {

namespace {
constexpr int kMostNewton = 30;
/// Shares of each step in u, so that impulses that depend on each other stay near those before: less by a
/// factor from step to step, from the first to the least.
constexpr double kProximal = 0.003, kProximalFactor = 0.7, kLeastProximal = 1e-5;
}  // namespace

/// The laws of all contacts, linear about the present impulses. What lifts off goes to zero, and so does
/// friction without a force on it.
void CoulombCluster::linearise(double proximal) {
  auto& [open, drop, movers] = scratch_.linear;
  open.clear();
  drop.clear();
  for (int i = 0; i < size_; ++i) {
    const Vec3<double> u = velocity(i);
    const double r = 1 / point(i).W.diagonal().maxCoeff(), ahead = p(i)[0] - r * u[0],
                 radius = point(i).mu * ahead;
    if (is_fixed(i) || !(ahead > 0)) {
      drop.push_back({i, -p(i)});
      continue;
    }
    LinearLaw law;
    law.contact = i;
    law.u = u;
    law.T = r * Mat3<double>::Identity();
    law.D = proximal * Mat3<double>::Identity();
    law.F = r * u;
    const Eigen::Vector2d pull = p(i).tail<2>() - r * u.tail<2>();
    if (point(i).rows == 1 || radius == 0) {  // it pushes along its normal
      drop.push_back({i, {0, -p(i)[1], -p(i)[2]}});
      law.T.bottomRows<2>().setZero();
      law.F.tail<2>().setZero();
    } else if (pull.norm() > radius) {
      const Eigen::Vector2d e = pull.normalized();
      const Eigen::Matrix2d turn = radius / pull.norm() * (Eigen::Matrix2d::Identity() - e * e.transpose());
      law.T.block<2, 1>(1, 0) = r * point(i).mu * e;
      law.T.block<2, 2>(1, 1) = r * turn;
      law.D.block<2, 1>(1, 0) = -point(i).mu * e;
      law.D.block<2, 2>(1, 1) += Eigen::Matrix2d::Identity() - turn;
      law.F.tail<2>() = p(i).tail<2>() - radius * e;
    }
    if (softness_ > 0) law.D += softness_ * law.T * point(i).W.diagonal().asDiagonal();
    open.push_back(law);
  }
}

/// The changes of the impulses of open contacts, by equations for what they push.
void CoulombCluster::solve_linear() {
  auto& [open, drop, movers] = scratch_.linear;
  Eigen::Matrix3Xd& TS_of_body = scratch_.TS;
  const double* numbers = system_.numbers_.data();
  movers.clear();
  for (LinearLaw& law : open) {
    const Point& at = point(law.contact);
    const Mat3<double> inverse = law.D.inverse();
    law.F = (inverse * law.F).eval();
    law.T = (inverse * law.T).eval();
    for (int r = at.first_push; r < at.last_push; ++r) {
      const CoulombSystem::Term& push = system_.pushes_[CoulombSystem::at(r)];
      const Eigen::Map<const MatX<double>> Y(numbers + push.numbers, push.size, 3);
      movers.add(push.first, Y.lazyProduct(-law.F));
      for (int s = at.first_side; s < at.last_side; ++s) {
        const CoulombSystem::Term& side = system_.sides_[CoulombSystem::at(s)];
        if (!movers.has(side.first)) continue;
        const Eigen::Map<const Eigen::Matrix3Xd> S(numbers + side.numbers, 3, side.size);
        if (push.size == 3 && side.size == 3) {
          const Mat3<double> TS = law.T * S.leftCols<3>();
          movers.add(push.first, side.first, Y.topRows<3>().lazyProduct(TS));
        } else {
          TS_of_body = law.T.lazyProduct(S);
          movers.add(push.first, side.first, Y.lazyProduct(TS_of_body));
        }
      }
    }
  }
  movers.solve();
  for (LinearLaw& law : open) {
    const Point& at = point(law.contact);
    Vec3<double> du = Vec3<double>::Zero();
    for (int s = at.first_side; s < at.last_side; ++s) {
      const CoulombSystem::Term& side = system_.sides_[CoulombSystem::at(s)];
      if (!movers.has(side.first)) continue;
      const Eigen::Map<const Eigen::Matrix3Xd> S(numbers + side.numbers, 3, side.size);
      du += S * movers.change(side.first, side.size);
    }
    law.dp = -law.F - law.T * du;
  }
}

/// Contacts couple what each of them pushes with all at its sides that any contact pushes.
void CoulombCluster::couple_movers() {
  auto& movers = scratch_.linear.movers;
  auto for_each_push = [&](auto&& act) {
    for (int i = 0; i < size_; ++i)
      for (int r = point(i).first_push; r < point(i).last_push; ++r)
        act(point(i), system_.pushes_[CoulombSystem::at(r)]);
  };
  movers.begin(system_.n_x());
  for_each_push(
      [&](const Point&, const CoulombSystem::Term& push) { movers.add_mover(push.first, push.size); });
  movers.number();
  for_each_push([&](const Point& at, const CoulombSystem::Term& push) {
    for (int s = at.first_side; s < at.last_side; ++s)
      if (const int side = system_.sides_[CoulombSystem::at(s)].first; movers.has(side))
        movers.couple(push.first, side);
  });
  movers.order();
}

/// Leaves the best it has seen; returns whether that is exact.
bool CoulombCluster::newton_of_points() {
  auto& [open, drop, movers] = scratch_.linear;
  VecX<double>& best = scratch_.best;
  take(best);
  double best_left = residual(), proximal = kProximal;
  couple_movers();
  for (int step = 0; step < kMostNewton && best_left > exact_; ++step) {
    linearise(proximal);
    for (const auto& [i, dp] : drop) push(i, dp);
    for (LinearLaw& law : open) law.F += law.T * (velocity(law.contact) - law.u);
    solve_linear();
    if (!std::all_of(open.begin(), open.end(), [](const LinearLaw& law) { return law.dp.allFinite(); }))
      break;
    for (const LinearLaw& law : open) push(law.contact, law.dp);
    const double left = residual();
    if (left < best_left) {
      take(best);
      best_left = left;
    }
    proximal = std::max(kProximalFactor * proximal, kLeastProximal);
  }
  set(best);
  return residual() <= exact_;
}

}  // namespace pliant
