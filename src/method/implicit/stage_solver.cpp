#include "stage_solver.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <sstream>

#include <Eigen/Geometry>

#include <pliant/body/advance.h>
#include <pliant/body/step_failure.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// An iteration that leaves more than this part of its change is slow.
constexpr double kSlow = 0.9;
constexpr int kMostStageIterations = 20;
/// Iterations without the matrix that a stage may take, if not so many as with it: of velocities, each of
/// which costs a matrix, once a step, two evaluations.
constexpr double kShareOfMatrix = 0.5;
/// Matrices that a stage may have of its own.
constexpr int kMostMatrices = 4;
/// Changes that no longer fall and are below this, in sizes and radians, are rounding.
constexpr double kStageRounding = 1e-12;
/// Differences, in sizes of what is varied.
constexpr double kDifference = 1e-7;
/// Most velocities in a dense matrix.
constexpr Eigen::Index kMostVelocities = 1000;
/// Changes below this, in tolerances, are taken for convergence.
constexpr double kConverged = 0.02;

/// The turn (rad, body frame) of each part that a change of quaternions is, all else as it is.
void to_tangent(const Model& model, const VecX<double>& q, const VecX<double>& change,
                VecX<double>& tangent) {
  tangent.resize(model.n_v());
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    tangent.segment<3>(m.v0) = change.segment<3>(m.q0);
    const auto theta = q.segment<4>(m.q0 + 3), by = change.segment<4>(m.q0 + 3);
    const Vec3<double> of = theta.tail<3>(), d = by.tail<3>();
    tangent.segment<3>(m.v0 + 3) = 2 / theta.squaredNorm() * (theta[0] * d - by[0] * of - of.cross(d));
    tangent.segment(m.v0 + 6, m.n_s + m.n_d()) = change.segment(m.q0 + 7, m.n_s + m.n_d());
  }
}

/// x <- x with the straight part of each part's share turned by its frame into the world, or back: stiff
/// directions turn with the parts, and the matrix with them.
enum class Turn { into_world, into_body };
void turn(const Model& model, const VecX<double>& q, Turn way, VecX<double>& x) {
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    const auto theta = q.segment<4>(m.q0 + 3);
    const Mat3<double> R =
        Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]).normalized().toRotationMatrix();
    auto straight = x.segment<3>(m.v0);
    straight =
        (way == Turn::into_world ? Vec3<double>(R * straight) : Vec3<double>(R.transpose() * straight));
  }
}

/// The first of the set that a part is in.
int leader(std::vector<int>& of, int i) {
  while (of[at(i)] != i) i = of[at(i)] = of[at(of[at(i)])];
  return i;
}

}  // namespace

StageSolver::StageSolver(const Model& model)
    : model_(model), difference_(model.n_v()), most_free_(kMostStageIterations) {
  const int n = static_cast<int>(model.parts().size());
  std::vector<int> set(at(n));
  std::iota(set.begin(), set.end(), 0);
  auto tie = [&](int a, int b) {
    if (a < 0 || b < 0 || model.parts()[at(a)].q0 < 0 || model.parts()[at(b)].q0 < 0) return;
    set[at(leader(set, std::max(a, b)))] = leader(set, std::min(a, b));
  };
  for (const SpringModel& spring : model.springs()) tie(spring.a.part, spring.b.part);
  for (const TorqueModel& torque : model.torques()) tie(torque.part, torque.against);
  for (const Island& island : model.islands())
    for (const int part : island.parts) tie(island.parts.front(), part);
  std::vector<int> cluster(at(n), -1);
  for (int i = 0; i < n; ++i) {
    const PartModel& m = model.parts()[at(i)];
    if (m.q0 < 0) continue;
    int& number = cluster[at(leader(set, i))];
    if (number < 0) {
      number = static_cast<int>(clusters_.size());
      clusters_.emplace_back();
    }
    Cluster& of = clusters_[at(number)];
    of.parts.push_back(i);
    for (int k = 0; k < m.n_v(); ++k) of.velocities.push_back(m.v0 + k);
    const double size = m.part->size();
    difference_.segment(m.v0, m.n_v()).setConstant(kDifference * size);
    difference_.segment<3>(m.v0 + 3).setConstant(kDifference);
    for (int k = 0; k < m.n_s; ++k)
      if (m.part->parameters().moving(k).spec->quantity != Quantity::length)
        difference_[m.v0 + 6 + k] = kDifference;
  }
  for (const Cluster& of : clusters_)
    most_free_ =
        std::max(most_free_, static_cast<int>(kShareOfMatrix * static_cast<double>(of.velocities.size())));
}

void StageSolver::begin(const Dynamics& dynamics, const State& state, double c, const ErrorScale& scale) {
  dynamics_ = &dynamics;
  state_ = &state;
  scale_ = &scale;
  c_ = c;
  linear_ = false;
}

void StageSolver::solve(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q,
                        VecX<double>& v, Workspace<double>& work, StepCounters& counters) {
  q_guess_ = q;
  v_guess_ = v;
  if (iterate(t, r_q, r_v, q, v, work, counters)) return;
  // Where the matrix of the start of the step, as of stiff parts that turn on each other, is no longer near,
  // that of the guess is taken, and then those of what it leads to.
  for (int i = linear_ ? 1 : 0; i <= kMostMatrices; ++i) {
    if (i <= 1) {
      q = q_guess_;
      v = v_guess_;
    }
    if (!q.allFinite() || !v.allFinite()) break;
    if (i == 0)
      linearise(state_->time(), state_->q, state_->v, work, counters);
    else
      linearise(t, q, v, work, counters);
    if (iterate(t, r_q, r_v, q, v, work, counters)) return;
  }
  std::ostringstream message;
  message << "the equations of an implicit step of " << state_->h << " s from t = " << state_->time()
          << " s have not been solved, worst " << scale_->worst(rho_q_, rho_v_, v)
          << "; a smaller step may cure it";
  throw NumericalFailure(message.str(), state_->time());
}

bool StageSolver::iterate(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q,
                          VecX<double>& v, Workspace<double>& work, StepCounters& counters) {
  const int most = linear_ ? kMostStageIterations : most_free_;
  double before = std::numeric_limits<double>::infinity();
  for (int i = 0; i < most; ++i) {
    dynamics_->accelerations(t, q, v, *state_, work, RankRule::keep);
    ++counters.evaluations;
    stop_inertialess(model_, work, v);
    dynamics_->coordinate_rates(q, v, rho_q_);
    rho_q_ = r_q + c_ * rho_q_ - q;
    rho_v_ = r_v + c_ * work.v_dot - v;
    correct(q, rho_q_, rho_v_);
    q += rho_q_;
    v += rho_v_;
    const double change = scale_->norm(rho_q_, rho_v_, v);
    if (!std::isfinite(change)) return false;
    const double left = change / before;  // of a change, by one more iteration
    const bool small = change <= kConverged && left / (1 - std::min(left, 0.99)) * change <= kConverged;
    if (change == 0 || (i > 0 && small)) return true;
    if (left > kSlow && change * scale_->tolerance() <= kStageRounding) return true;
    // The first change with the matrix is as crude as the guess was.
    const bool hopeless =
        linear_ ? i > 1 && left > kSlow : i > 0 && change * std::pow(left, most - 1 - i) > kConverged;
    if (hopeless) return false;
    before = change;
  }
  return false;
}

void StageSolver::correct(const VecX<double>& q, VecX<double>& rho_q, VecX<double>& rho_v) const {
  if (linear_) {
    to_tangent(model_, q, rho_q, tangent_);
    turn(model_, q, Turn::into_body, tangent_);
    turn(model_, q, Turn::into_body, rho_v);
    for (const Cluster& of : clusters_) {
      const auto n = static_cast<Eigen::Index>(of.velocities.size());
      right_.resize(n);
      for (Eigen::Index i = 0; i < n; ++i) right_[i] = tangent_[of.velocities[static_cast<std::size_t>(i)]];
      right_ = (c_ * of.A_q * right_).eval();
      for (Eigen::Index i = 0; i < n; ++i) right_[i] += rho_v[of.velocities[static_cast<std::size_t>(i)]];
      right_ = of.factor.solve(right_).eval();
      for (Eigen::Index i = 0; i < n; ++i) rho_v[of.velocities[static_cast<std::size_t>(i)]] = right_[i];
    }
    turn(model_, q, Turn::into_world, rho_v);
  }
  dynamics_->coordinate_rates(q, rho_v, tangent_);
  rho_q += c_ * tangent_;
}

void StageSolver::damp(VecX<double>& of_q, VecX<double>& of_v) const {
  if (linear_) correct(state_->q, of_q, of_v);
}

void StageSolver::linearise(double t, const VecX<double>& q0, const VecX<double>& v0, Workspace<double>& work,
                            StepCounters& counters) {
  Eigen::Index most = 0;
  for (Cluster& of : clusters_) {
    const auto n = static_cast<Eigen::Index>(of.velocities.size());
    if (n > kMostVelocities) {
      std::ostringstream message;
      message << n << " velocities of parts that act on each other are stiff, from part '"
              << model_.parts()[at(of.parts.front())].part->name() << "' on; expected at most "
              << kMostVelocities << " for this method, or linearly_implicit, or smaller steps";
      throw NumericalFailure(message.str(), t);
    }
    of.A_q.setZero(n, n);
    of.A_v.setZero(n, n);
    most = std::max(most, n);
  }
  dynamics_->accelerations(t, q0, v0, *state_, work, RankRule::keep);
  VecX<double> v_dot = work.v_dot;
  turn(model_, q0, Turn::into_body, v_dot);
  VecX<double> q = q0, v = v0;
  // A parameter that rests at a limit stays there.
  std::vector<bool> rests(static_cast<std::size_t>(model_.n_v()));
  for (const PartModel& m : model_.parts())
    for (int k = 0; m.q0 >= 0 && k < m.n_s; ++k)
      rests[at(m.v0 + 6 + k)] = state_->at_limit[at(m.limit0 + k)] != 0;
  for (Eigen::Index column = 0; column < most; ++column) {
    VecX<double> by = VecX<double>::Zero(v.size());
    for (const Cluster& of : clusters_) {
      if (column >= static_cast<Eigen::Index>(of.velocities.size())) continue;
      const Eigen::Index k = of.velocities[static_cast<std::size_t>(column)];
      if (!rests[static_cast<std::size_t>(k)]) by[k] = difference_[k];
    }
    VecX<double> change = by;
    turn(model_, q0, Turn::into_world, change);
    auto take = [&](MatX<double> Cluster::*A) {
      ++counters.evaluations;
      turn(model_, q0, Turn::into_body, work.v_dot);
      for (Cluster& of : clusters_) {
        const auto n = static_cast<Eigen::Index>(of.velocities.size());
        if (column >= n) continue;
        const double step = by[of.velocities[static_cast<std::size_t>(column)]];
        if (step == 0) continue;
        for (Eigen::Index i = 0; i < n; ++i) {
          const Eigen::Index k = of.velocities[static_cast<std::size_t>(i)];
          (of.*A)(i, column) = (work.v_dot[k] - v_dot[k]) / step;
        }
      }
    };
    q = q0;
    advance_coordinates(model_, q, change, 1);
    dynamics_->accelerations(t, q, v0, *state_, work, RankRule::keep);
    take(&Cluster::A_q);
    v = v0 + change;
    dynamics_->accelerations(t, q0, v, *state_, work, RankRule::keep);
    take(&Cluster::A_v);
  }
  for (Cluster& of : clusters_) {
    const Eigen::Index n = of.A_q.rows();
    of.factor.compute(MatX<double>::Identity(n, n) - c_ * of.A_v - c_ * c_ * of.A_q);
    ++counters.factorisations;
  }
  linear_ = true;
}

}  // namespace pliant
