// Function bodies of stage_solver.h: clusters, the Newton iteration of a stage, and the matrices by
// difference quotients.
#pragma once

#include <pliant/method/implicit/stage_solver.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

#include <Eigen/Geometry>

#include <pliant/body/advance.h>
#include <pliant/body/speed_scale.h>
#include <pliant/body/step_failure.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/math/scalar/power_of_two.h>

namespace pliant {

namespace stage_solver {

/// An iteration with the matrix ends without convergence if a change, from the third on, is more than this
/// fraction of the previous change.
inline constexpr double kSlowContraction = 0.9;
/// Largest number of iterations of a stage with one matrix.
inline constexpr int kMaxIterations = 20;
/// The largest number of iterations of a stage without the matrix is kFreeIterations times the number of
/// velocities of the largest cluster, but at least kMaxIterations. The matrix costs two evaluations for each
/// of these velocities.
inline constexpr double kFreeIterations = 0.5;
/// Largest number of matrices that are computed for one stage, in addition to the matrix at the start of the
/// step.
inline constexpr int kMaxMatrices = 4;
/// A change of at most this number, in sizes of the part and radians, is a rounding error if it is more than
/// kSlowContraction times the previous change. The iteration has then converged.
inline constexpr double kRounding = 1e-12;
/// Step of the difference quotients, relative to the scale of the coordinate: the size of the part for
/// lengths and local coordinates, this size times the square root of the mass for modes, 1 for angles and
/// other parameters.
inline constexpr double kDifference = 1e-7;
/// The iteration has converged if the last change and the expected remaining change are at most this number,
/// in tolerances.
inline constexpr double kConverged = 0.02;

/// Converts changes of coordinates (n_q) to a vector of n_v numbers: changes of quaternions become rotations
/// (rad, body frame), changes of other coordinates are copied.
inline void to_tangent(const Model& model, const VecX<double>& q, const VecX<double>& change,
                       VecX<double>& tangent) {
  tangent.resize(model.n_v());
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    tangent.segment<3>(m.v0) = change.segment<3>(m.q0);
    const auto theta = q.segment<4>(m.q0 + 3), theta_change = change.segment<4>(m.q0 + 3);
    const Vec3<double> axis = theta.tail<3>(), d = theta_change.tail<3>();
    tangent.segment<3>(m.v0 + 3) =
        2 / theta.squaredNorm() * (theta[0] * d - theta_change[0] * axis - axis.cross(d));
    tangent.segment(m.v0 + 6, m.n_s + m.n_d()) = change.segment(m.q0 + 7, m.n_s + m.n_d());
  }
}

enum class Frame { world, body };
/// Rotates the linear velocity of each part in x (n_v numbers) into the given frame: the world, or the frame
/// of the part. Stiff directions turn with the parts, so that the matrix stays valid in the frames of the
/// parts.
inline void rotate_velocities(const Model& model, const VecX<double>& q, Frame into, VecX<double>& x) {
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    const auto theta = q.segment<4>(m.q0 + 3);
    const Mat3<double> R =
        Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]).normalized().toRotationMatrix();
    auto velocity = x.segment<3>(m.v0);
    velocity = (into == Frame::world ? Vec3<double>(R * velocity) : Vec3<double>(R.transpose() * velocity));
  }
}

/// Returns the representative of the set of a part (union-find with path halving).
inline int find_root(std::vector<int>& parent, int i) {
  while (parent[at(i)] != i) i = parent[at(i)] = parent[at(parent[at(i)])];
  return i;
}

}  // namespace stage_solver

PLIANT_INLINE StageSolver::StageSolver(const Model& model)
    : model_(model), difference_(model.n_v()), max_free_iterations_(stage_solver::kMaxIterations) {
  const int n = static_cast<int>(model.parts().size());
  std::vector<int> set(at(n));
  std::iota(set.begin(), set.end(), 0);
  auto unite = [&](int a, int b) {
    if (a < 0 || b < 0 || model.parts()[at(a)].q0 < 0 || model.parts()[at(b)].q0 < 0) return;
    set[at(stage_solver::find_root(set, std::max(a, b)))] = stage_solver::find_root(set, std::min(a, b));
  };
  for (const auto& [one, other] : model.load_connections()) unite(one, other);
  for (const Island& island : model.islands())
    for (const int part : island.parts) unite(island.parts.front(), part);
  std::vector<int> cluster_of_root(at(n), -1);
  for (int i = 0; i < n; ++i) {
    const PartModel& m = model.parts()[at(i)];
    if (m.q0 < 0) continue;
    int& number = cluster_of_root[at(stage_solver::find_root(set, i))];
    if (number < 0) {
      number = static_cast<int>(clusters_.size());
      clusters_.emplace_back();
    }
    Cluster& cluster = clusters_[at(number)];
    cluster.parts.push_back(i);
    for (int k = 0; k < m.n_v(); ++k) cluster.velocities.push_back(m.v0 + k);
    const double size = m.size;
    difference_.segment(m.v0, m.n_v()).setConstant(stage_solver::kDifference * size);
    difference_.segment<3>(m.v0 + 3).setConstant(stage_solver::kDifference);
    for (int k = 0; k < m.n_s; ++k)
      if (m.part->parameters().moving(k).spec->quantity != Quantity::length)
        difference_[m.v0 + 6 + k] = stage_solver::kDifference;
    if (m.n_d() > 0) difference_.segment(m.v0 + 6 + m.n_s, m.n_d()).array() /= local_levers(m).array();
  }
  for (Cluster& cluster : clusters_) {
    cluster.scale.resize(static_cast<Eigen::Index>(cluster.velocities.size()));
    for (Eigen::Index i = 0; i < cluster.scale.size(); ++i)
      cluster.scale[i] = power_of_two(difference_[cluster.velocities[static_cast<std::size_t>(i)]]);
  }
  for (const Cluster& cluster : clusters_)
    max_free_iterations_ = std::max(
        max_free_iterations_,
        static_cast<int>(stage_solver::kFreeIterations * static_cast<double>(cluster.velocities.size())));
}

PLIANT_INLINE void StageSolver::begin_step(StepContext& step, double c, const ErrorScale& scale) {
  step_ = &step;
  scale_ = &scale;
  c_ = c;
  has_matrix_ = false;
}

PLIANT_INLINE void StageSolver::solve(double t, const VecX<double>& r_q, const VecX<double>& r_v,
                                      VecX<double>& q, VecX<double>& v) {
  q_guess_ = q;
  v_guess_ = v;
  if (iterate(t, r_q, r_v, q, v)) return;
  // The matrix is evaluated first at the start of the step (i = 0), then at the guess, then at the last
  // iterate.
  for (int i = has_matrix_ ? 1 : 0; i <= stage_solver::kMaxMatrices; ++i) {
    if (i <= 1) {
      q = q_guess_;
      v = v_guess_;
    }
    if (!q.allFinite() || !v.allFinite()) break;
    if (i == 0)
      linearise(step_->state.time(), step_->state.q, step_->state.v);
    else
      linearise(t, q, v);
    if (iterate(t, r_q, r_v, q, v)) return;
  }
  std::ostringstream message;
  message
      << "the equations of the implicit step did not converge: the largest change in the last iteration is "
         "that of "
      << scale_->worst(rho_q_, rho_v_, v);
  throw NumericalFailure(message.str(), step_->state.time());
}

PLIANT_INLINE bool StageSolver::iterate(double t, const VecX<double>& r_q, const VecX<double>& r_v,
                                        VecX<double>& q, VecX<double>& v) {
  const int max_iterations = has_matrix_ ? stage_solver::kMaxIterations : max_free_iterations_;
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < max_iterations; ++i) {
    const Workspace<double>& work = step_->work;
    step_->dynamics.accelerations(t, q, v, step_->state, step_->work, RankRule::keep);
    ++step_->counters.evaluations;
    zero_inertialess_velocities(model_, work, v);
    step_->dynamics.coordinate_rates(q, v, rho_q_);
    rho_q_ = r_q + c_ * rho_q_ - q;
    rho_v_ = r_v + c_ * work.v_dot - v;
    correct(q, rho_q_, rho_v_);
    q += rho_q_;
    v += rho_v_;
    const double change = scale_->norm(rho_q_, rho_v_, v);
    if (!std::isfinite(change)) return false;
    const double contraction = change / before;
    const bool small = change <= stage_solver::kConverged &&
                       contraction / (1 - std::min(contraction, 0.99)) * change <= stage_solver::kConverged;
    if (change == 0 || (i > 0 && small)) return true;
    if (contraction > stage_solver::kSlowContraction &&
        change * scale_->tolerance() <= stage_solver::kRounding)
      return true;
    // With the matrix, the ratio of the second change to the first depends on the error of the guess. The
    // contraction is therefore judged from the third change on.
    const bool too_slow = has_matrix_ ? i > 1 && contraction > stage_solver::kSlowContraction
                                      : i > 0 && change * std::pow(contraction, max_iterations - 1 - i) >
                                                     stage_solver::kConverged;
    if (too_slow) return false;
    before = change;
  }
  return false;
}

PLIANT_INLINE void StageSolver::correct(const VecX<double>& q, VecX<double>& rho_q,
                                        VecX<double>& rho_v) const {
  if (has_matrix_) {
    stage_solver::to_tangent(model_, q, rho_q, tangent_);
    stage_solver::rotate_velocities(model_, q, stage_solver::Frame::body, tangent_);
    stage_solver::rotate_velocities(model_, q, stage_solver::Frame::body, rho_v);
    for (const Cluster& cluster : clusters_) {
      const auto n = static_cast<Eigen::Index>(cluster.velocities.size());
      right_.resize(n);
      for (Eigen::Index i = 0; i < n; ++i)
        right_[i] = tangent_[cluster.velocities[static_cast<std::size_t>(i)]];
      right_ = (c_ * cluster.A_q * right_).eval();
      for (Eigen::Index i = 0; i < n; ++i)
        right_[i] += rho_v[cluster.velocities[static_cast<std::size_t>(i)]];
      right_ = cluster.factor.solve(right_.cwiseQuotient(cluster.scale)).cwiseProduct(cluster.scale).eval();
      for (Eigen::Index i = 0; i < n; ++i) rho_v[cluster.velocities[static_cast<std::size_t>(i)]] = right_[i];
    }
    stage_solver::rotate_velocities(model_, q, stage_solver::Frame::world, rho_v);
  }
  step_->dynamics.coordinate_rates(q, rho_v, tangent_);
  rho_q += c_ * tangent_;
}

PLIANT_INLINE void StageSolver::damp(VecX<double>& q_error, VecX<double>& v_error) const {
  if (has_matrix_) correct(step_->state.q, q_error, v_error);
}

PLIANT_INLINE void StageSolver::allocate_matrices(double t) {
  for (Cluster& cluster : clusters_) {
    const auto n = static_cast<Eigen::Index>(cluster.velocities.size());
    if (n > kMaxVelocities) {
      std::ostringstream message;
      message << "part '" << model_.parts()[at(cluster.parts.front())].part->name()
              << "' and the parts that joints, springs or torques connect to it have stiff motion and " << n
              << " velocities; expected at most " << kMaxVelocities
              << " for this method: use linearly_implicit or smaller steps";
      throw NumericalFailure(message.str(), t);
    }
    cluster.A_q.setZero(n, n);
    cluster.A_v.setZero(n, n);
  }
}

PLIANT_INLINE VecX<double> StageSolver::differences(Eigen::Index column) const {
  VecX<double> difference = VecX<double>::Zero(model_.n_v());
  for (const Cluster& cluster : clusters_)
    if (column < static_cast<Eigen::Index>(cluster.velocities.size())) {
      const Eigen::Index k = cluster.velocities[static_cast<std::size_t>(column)];
      difference[k] = difference_[k];
    }
  // A parameter at a limit does not change.
  const State& state = step_->state;
  for (const PartModel& m : model_.parts())
    for (int k = 0; m.q0 >= 0 && k < m.n_s; ++k)
      if (state.at_limit[at(m.limit0 + k)] != 0) difference[m.v0 + 6 + k] = 0;
  return difference;
}

PLIANT_INLINE void StageSolver::set_column(Eigen::Index column, const VecX<double>& difference,
                                           MatX<double> Cluster::*A) {
  const VecX<double>& v_dot = step_->work.v_dot;
  for (Cluster& cluster : clusters_) {
    const auto n = static_cast<Eigen::Index>(cluster.velocities.size());
    if (column >= n) continue;
    const double step = difference[cluster.velocities[static_cast<std::size_t>(column)]];
    if (step == 0) continue;
    for (Eigen::Index i = 0; i < n; ++i) {
      const Eigen::Index k = cluster.velocities[static_cast<std::size_t>(i)];
      (cluster.*A)(i, column) = (v_dot[k] - v_dot_[k]) / step;
    }
  }
}

PLIANT_INLINE void StageSolver::linearise(double t, const VecX<double>& q0, const VecX<double>& v0) {
  allocate_matrices(t);
  VecX<double>& v_dot = step_->work.v_dot;
  auto evaluate = [&](const VecX<double>& q, const VecX<double>& v) {
    step_->dynamics.accelerations(t, q, v, step_->state, step_->work, RankRule::keep);
  };
  evaluate(q0, v0);
  v_dot_ = v_dot;
  stage_solver::rotate_velocities(model_, q0, stage_solver::Frame::body, v_dot_);
  Eigen::Index columns = 0;
  for (const Cluster& cluster : clusters_) columns = std::max(columns, cluster.A_q.cols());
  VecX<double> q = q0, v = v0;
  for (Eigen::Index column = 0; column < columns; ++column) {
    const VecX<double> difference = differences(column);
    VecX<double> change = difference;
    stage_solver::rotate_velocities(model_, q0, stage_solver::Frame::world, change);
    auto evaluate_column = [&](MatX<double> Cluster::*A, double unit) {
      evaluate(q, v);
      ++step_->counters.evaluations;
      stage_solver::rotate_velocities(model_, q0, stage_solver::Frame::body, v_dot);
      set_column(column, unit * difference, A);
    };
    q = q0;
    advance_coordinates(model_, q, change, 1);
    v = v0;
    evaluate_column(&Cluster::A_q, 1);
    q = q0;
    v = v0 + slow_rate(model_) * change;
    evaluate_column(&Cluster::A_v, slow_rate(model_));
  }
  for (Cluster& cluster : clusters_) {
    const Eigen::Index n = cluster.A_q.rows();
    const MatX<double> matrix = MatX<double>::Identity(n, n) - c_ * cluster.A_v - c_ * c_ * cluster.A_q;
    cluster.factor.compute(cluster.scale.cwiseInverse().asDiagonal() * matrix * cluster.scale.asDiagonal());
    ++step_->counters.factorisations;
  }
  has_matrix_ = true;
}

}  // namespace pliant
