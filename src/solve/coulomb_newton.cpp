// Newton's method on Coulomb's law of all contacts of a cluster at once in the form of Alart and Curnier
// (1991),
//   p_n = (p_n - r u_n)+,   p_t = the point of the disc of radius mu (p_n - r u_n)+ nearest to p_t - r u_t.
#include <Eigen/LU>

#include "coulomb_cluster.h"

namespace pliant {

namespace {
constexpr int kMostNewton = 20;
/// Of these, in a row, that may make nothing better in clusters of more contacts than this, where they are
/// dear.
constexpr int kMostFutile = 4, kDear = 30;
/// Share of the step so far in u, so that impulses that depend on each other stay as near as they can.
constexpr double kProximal = 1e-9;
}  // namespace

/// Leaves the best it has seen; returns whether that is better than what it began with.
bool CoulombCluster::newton() {
  const Eigen::Index n = 3 * size_;
  MatX<double> A(n, n);  // takes the impulses to their velocities
  for (int i = 0; i < size_; ++i)
    for (int j = 0; j < size_; ++j) A.block<3, 3>(3 * i, 3 * j) = system_.effect(contacts_[i], contacts_[j]);
  if (softness_ > 0)
    for (int i = 0; i < size_; ++i) A.diagonal().segment<3>(3 * i) += softness_ * point(i).W.diagonal();
  VecX<double> best, F(n);
  take(best);
  const double start = residual();
  double best_left = start;
  MatX<double> K(n, n);
  int futile = 0;
  const int most_futile = size_ > kDear ? kMostFutile : kMostNewton;
  for (int step = 0; step < kMostNewton && futile < most_futile && best_left > exact_; ++step) {
    K.setZero();
    for (int i = 0; i < size_; ++i) {
      const Eigen::Index row = 3 * i;
      const Vec3<double> u = velocity(i);
      const double r = 1 / point(i).W.diagonal().maxCoeff(), ahead = p(i)[0] - r * u[0], mu = point(i).mu;
      const auto U = A.middleRows<3>(row);
      if (is_fixed(i) || !(ahead > 0)) {
        K.block<3, 3>(row, row).setIdentity();
        F.segment<3>(row) = p(i);
        continue;
      }
      K.row(row) = r * U.row(0);
      K(row, row) += kProximal;
      F[row] = r * u[0];
      auto tangents = K.middleRows<2>(row + 1);
      const Eigen::Vector2d pull = p(i).tail<2>() - r * u.tail<2>();
      const double radius = mu * ahead;
      if (point(i).rows == 1 || radius == 0) {
        K.block<2, 2>(row + 1, row + 1).setIdentity();
        F.segment<2>(row + 1) = p(i).tail<2>();
      } else if (pull.norm() <= radius) {
        tangents = r * U.bottomRows<2>();
        K.block<2, 2>(row + 1, row + 1) += kProximal * Eigen::Matrix2d::Identity();
        F.segment<2>(row + 1) = r * u.tail<2>();
      } else {
        const Eigen::Vector2d e = pull.normalized();
        const Eigen::Matrix2d turn = radius / pull.norm() * (Eigen::Matrix2d::Identity() - e * e.transpose());
        tangents = r * mu * e * U.row(0) + r * turn * U.bottomRows<2>();
        tangents.block<2, 1>(0, row) -= mu * e;
        tangents.block<2, 2>(0, row + 1) += Eigen::Matrix2d::Identity() - turn;
        F.segment<2>(row + 1) = p(i).tail<2>() - radius * e;
      }
    }
    const VecX<double> change = -K.partialPivLu().solve(F);
    if (!change.allFinite()) break;
    for (int i = 0; i < size_; ++i) push(i, change.segment<3>(3 * i));
    const double left = residual();
    ++futile;
    if (left < best_left) {
      futile = 0;
      take(best);
      best_left = left;
    }
  }
  set(best);
  return best_left < start;
}

}  // namespace pliant
