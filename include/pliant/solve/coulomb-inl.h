// The solution of Coulomb's law at one contact: separation, sticking, or sliding with a scalar Newton
// iteration.
#pragma once

#include <pliant/solve/coulomb.h>

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {
inline constexpr int kMaxSlideIterations = 200;
/// In one iteration of slide(), s = |u_t| / |p_t| grows at most to this factor times the larger of s and the
/// largest eigenvalue of A (coulomb.h). The limit holds while no upper bound of s is known.
inline constexpr double kSlideRateGrowth = 16;
/// Relative difference of two values of s below which the iteration ends.
inline constexpr double kSameSlideRate = 2 * std::numeric_limits<double>::epsilon();
/// Relative difference below which W is treated as a multiple of the identity.
inline constexpr double kIsotropicContact = 1e-11;
}  // namespace detail

PLIANT_INLINE CoulombLaw::CoulombLaw() = default;

PLIANT_INLINE CoulombLaw::CoulombLaw(const Mat3<double>& W, double mu)
    : mu_(mu), W_n_(W(0, 0)), coupling_(W.block<2, 1>(1, 0)) {
  if (!(mu > 0)) return;
  isotropic_ =
      (W - W_n_ * Mat3<double>::Identity()).lpNorm<Eigen::Infinity>() <= detail::kIsotropicContact * W_n_;
  if (isotropic_) return;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> modes;
  A_ = W.block<2, 2>(1, 1) - coupling_ * coupling_.transpose() / W_n_;
  modes.computeDirect(A_);
  stiffness_ = modes.eigenvalues();
  modes_ = modes.eigenvectors();
}

PLIANT_INLINE Vec3<double> CoulombLaw::stick(double p_frictionless, const Eigen::Vector2d& c) const {
  // Solves A p_t = -c by the factors L D L^T of A. The first pivot is the larger diagonal entry of A. If the
  // second pivot is zero to rounding, the impulse along the other tangent is zero. Without a positive pivot
  // there is no tangential impulse.
  const int i = A_(0, 0) < A_(1, 1) ? 1 : 0, j = 1 - i;
  if (!(A_(i, i) > 0)) return {p_frictionless, 0, 0};
  const double l = A_(j, i) / A_(i, i), pivot = A_(j, j) - l * A_(i, j);
  Eigen::Vector2d p_t;
  p_t[j] = pivot > std::numeric_limits<double>::epsilon() * A_(j, j) ? -(c[j] - l * c[i]) / pivot : 0;
  p_t[i] = -c[i] / A_(i, i) - l * p_t[j];
  return {p_frictionless - coupling_.dot(p_t) / W_n_, p_t[0], p_t[1]};
}

PLIANT_INLINE Vec3<double> CoulombLaw::impulse(const Vec3<double>& b) const {
  if (!(b[0] < 0)) return Vec3<double>::Zero();
  const double p_frictionless = -b[0] / W_n_;  // normal impulse without friction
  if (!(mu_ > 0)) return {p_frictionless, 0, 0};
  if (isotropic_) {
    const Eigen::Vector2d stop = -b.tail<2>() / W_n_;
    const double limit = mu_ * p_frictionless, size = stop.norm();
    const double share = size > limit ? limit / size : 1;
    return {p_frictionless, share * stop[0], share * stop[1]};
  }
  const Eigen::Vector2d c = b.tail<2>() + coupling_ * p_frictionless;
  const Vec3<double> p = stick(p_frictionless, c);
  const bool sticks = p[0] > 0 && p.tail<2>().norm() <= mu_ * p[0];
  return sticks ? p : slide(p_frictionless, c);
}

PLIANT_INLINE Vec3<double> CoulombLaw::slide(double p_frictionless, const Eigen::Vector2d& c) const {
  // Sliding: u_t = -s p_t with s > 0, and u_n = 0. Then (A + s) p_t = -c.
  const Eigen::Array2d along = modes_.transpose() * c;
  const Eigen::Array2d coupling = modes_.transpose() * coupling_ / W_n_;
  Eigen::Array2d t;  // p_t along the modes
  double p_n = 0;
  // Newton's method with bounds for a root of f(s) = mu p_n / |p_t| - 1. f is negative at s = 0, because the
  // contact does not stick. For large s it is nearly linear and increases without bound: |p_t| decreases to 0
  // and p_n tends to p_frictionless > 0.
  double low = 0, high = std::numeric_limits<double>::infinity(), s = 0;
  for (int i = 0; i < detail::kMaxSlideIterations; ++i) {
    const Eigen::Array2d share = 1 / (stiffness_ + s);
    t = -along * share;
    p_n = p_frictionless - (coupling * t).sum();
    const double size = std::sqrt(t.square().sum()), f = mu_ * p_n / size - 1;
    if (f == 0) break;
    (f < 0 ? low : high) = s;
    const Eigen::Array2d t_s = -t * share;  // dt/ds
    const double slope = -mu_ * ((coupling * t_s).sum() + p_n * (t * t_s).sum() / (size * size)) / size;
    const bool bounded = std::isfinite(high);
    double next = s - f / slope;
    if (!bounded) next = std::min(next, detail::kSlideRateGrowth * std::max(s, stiffness_[1]));
    if (!(next > low && next < high))
      next = bounded ? 0.5 * (low + high) : detail::kSlideRateGrowth * std::max(s, stiffness_[1]);
    if (!std::isfinite(next)) return {p_frictionless, 0, 0};
    if (std::abs(next - s) <= detail::kSameSlideRate * next ||
        (bounded && high - low <= detail::kSameSlideRate * high))
      break;
    s = next;
  }
  const Eigen::Vector2d p_t = modes_ * t.matrix();
  return {p_n, p_t[0], p_t[1]};
}

}  // namespace pliant
