#include <pliant/solve/coulomb.h>

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace pliant {

namespace {
constexpr int kMostIterations = 200;
/// W that differs from a multiple of 1 by less than this part is one.
constexpr double kEven = 1e-11;
}  // namespace

CoulombLaw::CoulombLaw(const Mat3<double>& W, double mu)
    : mu_(mu), W_n_(W(0, 0)), coupling_(W.block<2, 1>(1, 0)) {
  if (!(mu > 0)) return;
  even_ = (W - W_n_ * Mat3<double>::Identity()).lpNorm<Eigen::Infinity>() <= kEven * W_n_;
  if (even_) return;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes;
  modes.computeDirect(Eigen::Matrix2d(W.block<2, 2>(1, 1) - coupling_ * coupling_.transpose() / W_n_));
  stiffness_ = modes.eigenvalues();
  modes_ = modes.eigenvectors();
  factor_.compute(W);
}

Vec3<double> CoulombLaw::push(const Vec3<double>& b) const {
  if (!(b[0] < 0)) return Vec3<double>::Zero();
  const double p_alone = -b[0] / W_n_;  // without friction
  if (!(mu_ > 0)) return {p_alone, 0, 0};
  if (even_) {
    const Eigen::Vector2d stop = -b.tail<2>() / W_n_;
    const double most = mu_ * p_alone, size = stop.norm();
    const double share = size > most ? most / size : 1;
    return {p_alone, share * stop[0], share * stop[1]};
  }
  const Vec3<double> stick = -factor_.solve(b);
  if (stick[0] > 0 && stick.tail<2>().norm() <= mu_ * stick[0]) return stick;
  return slide(b, p_alone);
}

Vec3<double> CoulombLaw::slide(const Vec3<double>& b, double p_alone) const {
  // It slides at u_t = -s p_t, s > 0, with u_n = 0: (A + s) p_t = -c, A the Schur complement of the normal.
  const Eigen::Vector2d along = modes_.transpose() * (b.tail<2>() + coupling_ * p_alone);
  const auto push = [&](double s) {
    const Eigen::Vector2d t = modes_ * (-along.array() / (stiffness_.array() + s)).matrix();
    return Vec3<double>(p_alone - coupling_.dot(t) / W_n_, t[0], t[1]);
  };
  const auto beyond = [&](double s) {
    const Vec3<double> p = push(s);
    return p.tail<2>().norm() - mu_ * p[0];
  };
  // |p_t| falls with s to 0, and p_n goes to p_alone > 0: there is a root.
  double low = 0, high = stiffness_[1];
  while (beyond(high) > 0) {
    low = high;
    high *= 4;
    if (!std::isfinite(high)) return {p_alone, 0, 0};
  }
  // The Illinois form of the false position, on 1 / |p_t| against 1 / (mu p_n), which is nearly straight.
  const auto level = [&](double s) {
    const Vec3<double> p = push(s);
    return p[0] > 0 ? mu_ * p[0] / p.tail<2>().norm() - 1 : -1.0;
  };
  double f_low = level(low), f_high = level(high);
  int side = 0;
  for (int i = 0; i < kMostIterations && high - low > 2 * std::numeric_limits<double>::epsilon() * high;
       ++i) {
    double s = f_high > f_low ? low - f_low * (high - low) / (f_high - f_low) : 0.5 * (low + high);
    if (!(s > low && s < high)) s = 0.5 * (low + high);
    if (!(s > low && s < high)) break;
    const double f = level(s);
    if (f == 0) return push(s);
    if (f < 0) {
      low = s;
      f_low = f;
      if (side < 0) f_high *= 0.5;
      side = -1;
    } else {
      high = s;
      f_high = f;
      if (side > 0) f_low *= 0.5;
      side = 1;
    }
  }
  return push(high);
}

}  // namespace pliant
