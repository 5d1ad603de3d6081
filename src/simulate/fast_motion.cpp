// Arnoldi's method for the fastest small motions (fast_motion.h).
#include <pliant/simulate/fast_motion.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include <pliant/math/eigenvalues.h>
#include <pliant/math/index.h>
#include <pliant/part/local/nodal_deformation.h>

namespace pliant {

namespace fast_motion {

/// The Krylov space has at most kMaxVectors vectors, and all vectors have at most kMaxNumbers entries in
/// total. In large models, kFewVectors vectors are allowed in any case.
constexpr Eigen::Index kMaxVectors = 160, kMaxNumbers = 20'000'000, kFewVectors = 24;
/// Largest change of a coordinate in a difference, relative to its scale.
constexpr double kDifference = 1e-6;
/// A new vector whose norm is below this share of largest_ consists of errors of the differences; the Krylov
/// space is then complete.
constexpr double kVanished = 1e-7;
/// Let r (1/s) be the square root of the largest ratio of an acceleration to the scale of its coordinate.
/// Derivatives of the accelerations up to kNoise r^2 (by coordinates) and kNoise r (by velocities) are errors
/// of the differences.
constexpr double kNoise = 1e-8;
/// Number of steps of the power method that estimate the typical rate.
constexpr int kPowers = 6;

}  // namespace fast_motion

FastMotions::FastMotions(const Dynamics& dynamics, const State& state, std::vector<bool> moves)
    : dynamics_(dynamics), state_(state), moves_(std::move(moves)) {
  dynamics_.accelerations(state_.time(), state_.q, state_.v, state_, work_);
  set_scales();
  const Eigen::Index n = state_.v.size();
  VecX<double> x(n);
  for (Eigen::Index i = 0; i < n; ++i)
    x[i] = weight_[i] > 0 ? std::sin(1.0 + static_cast<double>(i)) / weight_[i] : 0;
  const VecX<double> none = VecX<double>::Zero(n);
  const double acceleration = work_.v_dot.cwiseQuotient(length_).cwiseAbs().maxCoeff();
  if (acceleration > 0) rate_ = std::sqrt(acceleration);
  const double noise = fast_motion::kNoise * rate_;
  double stiffness = 0, damping = 0;
  VecX<double> along = x;
  for (int i = 0; i < fast_motion::kPowers; ++i) {
    const VecX<double> next = derivative(along, none);
    const double before = weight_.cwiseProduct(along).norm(), after = weight_.cwiseProduct(next).norm();
    if (!(before > 0) || !(after > noise * rate_ * before)) break;
    stiffness = after / before;
    along = next / after;
  }
  if (stiffness > 0) rate_ = std::sqrt(stiffness);
  along = x;
  for (int i = 0; i < fast_motion::kPowers; ++i) {
    const VecX<double> next = derivative(none, along);
    const double before = weight_.cwiseProduct(along).norm(), after = weight_.cwiseProduct(next).norm();
    if (!(before > 0) || !(after > noise * before)) break;
    damping = after / before;
    along = next / after;
  }
  rate_ = std::max(std::sqrt(stiffness), damping);
  if (!(rate_ > 0) || !std::isfinite(rate_)) return;
  const VecX<double> start = scaled(x, rate_ * x);
  basis_.push_back(start / start.norm());
}

/// Sets the scales of the coordinates. Velocities that are constant have the weight 0.
void FastMotions::set_scales() {
  const Model& model = dynamics_.model();
  length_.setOnes(model.n_v());
  weight_.setZero(model.n_v());
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.q0 < 0) continue;
    const double size = m.size;
    length_.segment(m.v0, m.n_v()).setConstant(size);
    length_.segment<3>(m.v0 + 3).setOnes();
    const MatX<double> M = mass_matrix(work_.parts[i]);
    weight_.segment(m.v0, 6 + m.n_s) = M.diagonal().head(6 + m.n_s);
    for (int k = 0; k < m.n_s; ++k) {
      if (m.part->parameters().moving(k).spec->quantity != Quantity::length) length_[m.v0 + 6 + k] = 1;
      if (state_.at_limit[at(m.limit0 + k)] != 0) weight_[m.v0 + 6 + k] = 0;
    }
    if (m.local == nullptr) continue;
    auto local = weight_.segment(m.v0 + 6 + m.n_s, m.n_d());
    if (m.local->nodal() != nullptr)
      local = m.local->nodal()->inertia();
    else
      local.setOnes();  // modes are mass-normalised
  }
  for (Eigen::Index i = 0; i < weight_.size(); ++i)
    weight_[i] = moves_[static_cast<std::size_t>(i)] && weight_[i] > 0 ? std::sqrt(weight_[i]) : 0;
}

VecX<double> FastMotions::scaled(const VecX<double>& x, const VecX<double>& x_dot) const {
  VecX<double> u(2 * x.size());
  u << rate_ * weight_.cwiseProduct(x), weight_.cwiseProduct(x_dot);
  return u;
}

VecX<double> FastMotions::derivative(const VecX<double>& x, const VecX<double>& x_dot) {
  double largest = x.cwiseQuotient(length_).cwiseAbs().maxCoeff();
  const double rate = rate_ > 0 ? rate_ : 1;
  largest = std::max(largest, x_dot.cwiseQuotient(length_).cwiseAbs().maxCoeff() / rate);
  if (!(largest > 0)) return VecX<double>::Zero(x.size());
  const double step = fast_motion::kDifference / largest;
  VecX<double> q_dot, change;
  dynamics_.coordinate_rates(state_.q, x, q_dot);
  for (const double side : {1.0, -1.0}) {
    dynamics_.accelerations(state_.time(), state_.q + side * step * q_dot, state_.v + side * step * x_dot,
                            state_, work_, RankRule::keep);
    change = side > 0 ? work_.v_dot : VecX<double>(change - work_.v_dot);
  }
  change /= 2 * step;
  for (Eigen::Index i = 0; i < change.size(); ++i)
    if (weight_[i] == 0) change[i] = 0;
  return change;
}

VecX<double> FastMotions::image(const VecX<double>& u) {
  const Eigen::Index n = weight_.size();
  VecX<double> x(n), x_dot(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    x[i] = weight_[i] > 0 ? u[i] / (rate_ * weight_[i]) : 0;
    x_dot[i] = weight_[i] > 0 ? u[n + i] / weight_[i] : 0;
  }
  return scaled(x_dot, derivative(x, x_dot));
}

bool FastMotions::extend(int count) {
  const auto n = 2 * weight_.size();
  const Eigen::Index most =
      std::min({n, fast_motion::kMaxVectors,
                std::max(fast_motion::kFewVectors, fast_motion::kMaxNumbers / std::max<Eigen::Index>(1, n))});
  for (int i = 0; i < count; ++i) {
    const auto k = static_cast<Eigen::Index>(basis_.size()) - 1;
    if (k < 0 || k == most) return false;
    H_.conservativeResizeLike(MatX<double>::Zero(k + 2, k + 1));
    VecX<double> u = image(basis_.back());
    largest_ = std::max(largest_, u.norm());
    for (int pass = 0; pass < 2; ++pass)
      for (Eigen::Index j = 0; j <= k; ++j) {
        const double share = basis_[static_cast<std::size_t>(j)].dot(u);
        H_(j, k) += share;
        u -= share * basis_[static_cast<std::size_t>(j)];
      }
    const double norm = u.norm();
    if (!std::isfinite(norm)) return false;
    if (!(norm > fast_motion::kVanished * largest_)) return false;
    H_(k + 1, k) = norm;
    basis_.push_back(u / norm);
  }
  return true;
}

std::vector<FastMotion> FastMotions::motions() const {
  std::vector<FastMotion> all;
  const Eigen::Index n = H_.cols();
  if (n == 0 || !H_.allFinite()) return all;
  const ComplexEigenpairs pairs = eigenpairs(H_.topRows(n));
  const double largest = pairs.values.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < n; ++i) {
    FastMotion motion;
    motion.value = pairs.values[i];
    // Motions without stiffness and damping have the double eigenvalue 0, which errors split into two small
    // numbers.
    if (!(std::abs(motion.value) > std::sqrt(fast_motion::kVanished) * largest)) continue;
    motion.combination = pairs.vectors.col(i).normalized();
    motion.residual = H_(n, n - 1) * std::abs(motion.combination[n - 1]) / std::abs(motion.value);
    all.push_back(motion);
  }
  return all;
}

VecX<std::complex<double>> FastMotions::velocities(const FastMotion& motion) const {
  VecX<std::complex<double>> u = VecX<std::complex<double>>::Zero(weight_.size());
  for (Eigen::Index k = 0; k < motion.combination.size(); ++k)
    u += motion.combination[k] * basis_[static_cast<std::size_t>(k)].tail(weight_.size());
  return u;
}

MotionPlace FastMotions::place(const FastMotion& motion) const {
  const Model& model = dynamics_.model();
  const VecX<std::complex<double>> u = velocities(motion);
  MotionPlace place;
  double most = -1;
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.q0 < 0) continue;
    const double rigid = u.segment<6>(m.v0).squaredNorm(),
                 parameters = u.segment(m.v0 + 6, m.n_s).squaredNorm(),
                 local = u.segment(m.v0 + 6 + m.n_s, m.n_d()).squaredNorm();
    if (!(rigid + parameters + local > most)) continue;
    most = rigid + parameters + local;
    place.part = static_cast<int>(i);
    place.is_local = local > rigid && local > parameters;
    place.is_of_parameters = parameters > rigid && !place.is_local;
  }
  return place;
}

FastMotions::Resistance FastMotions::resistance(const FastMotion& motion) {
  if (motion.value.imag() != 0) return {std::norm(motion.value), std::max(0.0, -2 * motion.value.real())};
  const VecX<double> u = velocities(motion).real();
  VecX<double> x(u.size());
  for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = weight_[i] > 0 ? u[i] / weight_[i] : 0;
  const VecX<double> none = VecX<double>::Zero(x.size());
  const auto along = [&](const VecX<double>& force) {
    return -u.dot(weight_.cwiseProduct(force)) / u.squaredNorm();
  };
  return {std::max(0.0, along(derivative(x, none))), std::max(0.0, along(derivative(none, x)))};
}

}  // namespace pliant
