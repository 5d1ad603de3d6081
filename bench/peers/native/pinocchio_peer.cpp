// Explicit Runge-Kutta methods with the forward dynamics of Pinocchio.
//
//   pinocchio_peer PROBLEM TABLEAU fixed STEPS | pinocchio_peer PROBLEM TABLEAU adaptive TOLERANCE
//
// PROBLEM: file that native_peer.py writes; TABLEAU: file that pinocchio_peer.py writes. The articulated-body
// algorithm computes accelerations of trees, and constraintDynamics those of systems with loops.
#include <cmath>
#include <cstring>
#include <exception>
#include <memory>

#include <pinocchio/multibody.hpp>

#include <pinocchio/algorithm/aba.hpp>
#include <pinocchio/algorithm/constrained-dynamics.hpp>
#include <pinocchio/algorithm/joint-configuration.hpp>
#include <pinocchio/algorithm/kinematics.hpp>

#include "problem.h"

namespace pin = pinocchio;
using Eigen::MatrixXd;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

Vector3d vec(const peers::Vec3& v) {
  return {v[0], v[1], v[2]};
}
Quaterniond quat(const peers::Quat& q) {
  return {q[0], q[1], q[2], q[3]};
}

/// The coefficients of a Runge-Kutta method.
struct Tableau {
  MatrixXd A;  ///< stages x stages, strictly lower
  VectorXd b;
  MatrixXd E;  ///< 2 x (stages + 1): weights of the errors of orders 3 and 5; empty without error control
};

Tableau read_tableau(const std::string& path) {
  std::ifstream in(path);
  int stages = 0, errors = 0;
  in >> stages >> errors;
  Tableau t{MatrixXd(stages, stages), VectorXd(stages), MatrixXd(errors, stages + 1)};
  for (double& x : t.A.reshaped<Eigen::RowMajor>()) in >> x;
  for (double& x : t.b) in >> x;
  for (double& x : t.E.reshaped<Eigen::RowMajor>()) in >> x;
  if (!in) throw std::runtime_error("cannot read " + path);
  return t;
}

class System {
 public:
  explicit System(const peers::Problem& problem) : problem_(problem), joint_of_(problem.bodies.size(), 0) {
    model_.gravity.linear(vec(problem.gravity));
    std::vector<Vector3d> origin(problem.bodies.size(),
                                 Vector3d::Zero());  // position of the joint in the body frame
    auto add = [&](int parent, const Vector3d& parent_point, int child, const Vector3d& point,
                   const auto& kind) {
      const auto c = static_cast<std::size_t>(child);
      const peers::Body& body = problem.bodies[c];
      const bool rooted = parent < 0;
      const auto p = static_cast<std::size_t>(std::max(parent, 0));
      const pin::SE3 place(Eigen::Matrix3d::Identity(),
                           rooted ? parent_point : Vector3d(parent_point - origin[p]));
      joint_of_[c] = model_.addJoint(rooted ? 0 : joint_of_[p], kind, place, "body" + std::to_string(child));
      const Eigen::Matrix3d inertia = vec(body.inertia).asDiagonal();
      model_.appendBodyToJoint(joint_of_[c], pin::Inertia(body.mass, -point, inertia), pin::SE3::Identity());
      origin[c] = point;
    };
    for (const peers::Joint& j : problem.tree)
      add(j.a, vec(j.ra), j.b, vec(j.rb), pin::JointModelSpherical());
    if (problem.tree.empty())
      for (std::size_t i = 0; i < problem.bodies.size(); ++i)
        add(-1, Vector3d::Zero(), static_cast<int>(i), Vector3d::Zero(), pin::JointModelFreeFlyer());
    constexpr double kMaxBytes = 8e9;
    const double bytes = 4 * sizeof(double) * std::pow(model_.nv, 3);
    if (bytes > kMaxBytes)
      throw std::runtime_error(
          "pinocchio::Data needs four arrays of nv^3 numbers: " + std::to_string(bytes / 1e9) + " GB");
    data_ = std::make_unique<pin::Data>(model_);
    tau_ = VectorXd::Zero(model_.nv);
    for (const peers::Joint& j : problem.loops) {
      const auto [ja, pa] = place(j.a, vec(j.ra), origin);
      const auto [jb, pb] = place(j.b, vec(j.rb), origin);
      loops_.emplace_back(pin::CONTACT_3D, model_, ja, pa, jb, pb, pin::LOCAL);
    }
    for (const auto& loop : loops_) loop_data_.emplace_back(loop);
    if (!loops_.empty()) pin::initConstraintDynamics(model_, *data_, loops_, loop_data_);
    start_state();
  }

  const VectorXd& start() const { return start_; }

  /// Computes dy, the time derivative of y = (q, v), Pinocchio's coordinates and velocities of the tree.
  void rate(const VectorXd& y, VectorXd& dy) {
    q_ = y.head(model_.nq);
    pin::normalize(model_, q_);
    v_ = y.tail(model_.nv);
    for (pin::JointIndex j = 1; j < model_.joints.size(); ++j) {
      const int q0 = model_.idx_qs[j], v0 = model_.idx_vs[j], free = model_.nqs[j] == 7 ? 3 : 0;
      const Quaterniond q(q_.segment<4>(q0 + free));
      const Vector3d w = v_.segment<3>(v0 + free);
      if (free) dy.segment<3>(q0) = q * v_.segment<3>(v0);
      dy.segment<4>(q0 + free) = 0.5 * (q * Quaterniond(0, w[0], w[1], w[2])).coeffs();
    }
    if (loops_.empty())
      dy.tail(model_.nv) = pin::aba(model_, *data_, q_, v_, tau_);
    else
      dy.tail(model_.nv) =
          pin::constraintDynamics(model_, *data_, q_, v_, tau_, loops_, loop_data_, settings_);
  }
  void normalize(VectorXd& y) {
    q_ = y.head(model_.nq);
    pin::normalize(model_, q_);
    y.head(model_.nq) = q_;
  }

  std::vector<peers::Pose> poses(const VectorXd& y) {
    q_ = y.head(model_.nq);
    pin::normalize(model_, q_);
    pin::forwardKinematics(model_, *data_, q_);
    std::vector<peers::Pose> out;
    for (const pin::JointIndex j : joint_of_) {
      const Vector3d c = data_->oMi[j].act(model_.inertias[j].lever());
      const Quaterniond q(data_->oMi[j].rotation());
      out.push_back({{c[0], c[1], c[2]}, {q.w(), q.x(), q.y(), q.z()}});
    }
    return out;
  }

 private:
  std::pair<pin::JointIndex, pin::SE3> place(int body, const Vector3d& point,
                                             const std::vector<Vector3d>& origin) const {
    if (body < 0) return {0, pin::SE3(Eigen::Matrix3d::Identity(), point)};
    const auto k = static_cast<std::size_t>(body);
    return {joint_of_[k], pin::SE3(Eigen::Matrix3d::Identity(), point - origin[k])};
  }
  void start_state() {
    start_ = VectorXd::Zero(model_.nq + model_.nv);
    auto joint = [&](int body) { return joint_of_[static_cast<std::size_t>(body)]; };
    for (const peers::Joint& j : problem_.tree) {
      const peers::Body& child = problem_.bodies[static_cast<std::size_t>(j.b)];
      Quaterniond turn = quat(child.quat);
      Vector3d omega = vec(child.omega);
      if (j.a >= 0) {
        const peers::Body& parent = problem_.bodies[static_cast<std::size_t>(j.a)];
        turn = quat(parent.quat).conjugate() * turn;
        omega -= vec(parent.omega);
      }
      start_.segment<4>(model_.idx_qs[joint(j.b)]) = turn.coeffs();
      start_.segment<3>(model_.nq + model_.idx_vs[joint(j.b)]) = quat(child.quat).conjugate() * omega;
    }
    if (!problem_.tree.empty()) return;
    for (std::size_t i = 0; i < problem_.bodies.size(); ++i) {
      const peers::Body& body = problem_.bodies[i];
      const int q = model_.idx_qs[joint_of_[i]], v = model_.nq + model_.idx_vs[joint_of_[i]];
      start_.segment<3>(q) = vec(body.pos);
      start_.segment<4>(q + 3) = quat(body.quat).coeffs();
      start_.segment<3>(v) = quat(body.quat).conjugate() * vec(body.vel);
      start_.segment<3>(v + 3) = quat(body.quat).conjugate() * vec(body.omega);
    }
  }

  const peers::Problem& problem_;
  std::vector<pin::JointIndex> joint_of_;
  pin::Model model_;
  std::unique_ptr<pin::Data> data_;
  std::vector<pin::RigidConstraintModel> loops_;
  std::vector<pin::RigidConstraintData> loop_data_;
  pin::ProximalSettings settings_{1e-14, 0, 1};
  VectorXd tau_, start_, q_, v_;
};

class RungeKutta {
 public:
  RungeKutta(System& system, const Tableau& tableau)
      : system_(system), tableau_(tableau), K_(system.start().size(), tableau.b.size() + 1) {}

  void fixed(VectorXd& y, double end, long steps) {
    const double h = end / static_cast<double>(steps);
    for (long i = 0; i < steps; ++i) {
      rate(y, 0);
      stages(y, h);
      y = next_;
      system_.normalize(y);
    }
  }

  /// Integrates from 0 to `end` (s) with the error norm of Hairer's DOP853 and a similar
  /// control of the step. The last stage of a step is the
  /// first stage of the next one.
  void adaptive(VectorXd& y, double end, double tolerance) {
    const auto last = tableau_.b.size();
    double t = 0, h = 1e-3;
    rate(y, 0);
    while (t < end) {
      const bool final = t + h >= end;
      if (final) h = end - t;
      if (h < 1e-12) throw std::runtime_error("step too small");
      stages(y, h);
      rate(next_, last);
      const auto scale = (1 + y.array().abs().max(next_.array().abs())) * tolerance;
      const double n = static_cast<double>(y.size());
      const double e3 = ((K_ * tableau_.E.row(0).transpose()).array() / scale).square().sum(),
                   e5 = ((K_ * tableau_.E.row(1).transpose()).array() / scale).square().sum();
      const double error = h * e5 / std::sqrt(std::max(1e-300, n * (e5 + 0.01 * e3)));
      if (!std::isfinite(error)) throw std::runtime_error("the error estimate of a step is not finite");
      const double factor = std::clamp(0.9 * std::pow(std::max(error, 1e-30), -1.0 / 8), 0.2, 6.0);
      if (error <= 1) {
        t = final ? end : t + h;
        y = next_;
        system_.normalize(y);
        K_.col(0) = K_.col(last);
      }
      h *= error <= 1 ? factor : std::min(factor, 1.0);
    }
  }

 private:
  void rate(const VectorXd& y, Eigen::Index stage) {
    system_.rate(y, dy_);
    K_.col(stage) = dy_;
  }
  void stages(const VectorXd& y, double h) {
    const auto n = tableau_.b.size();
    for (Eigen::Index s = 1; s < n; ++s) {
      stage_ = y;
      stage_.noalias() += K_.leftCols(s) * (h * tableau_.A.row(s).head(s).transpose());
      rate(stage_, s);
    }
    next_ = y;
    next_.noalias() += K_.leftCols(n) * (h * tableau_.b);
  }

  System& system_;
  const Tableau& tableau_;
  MatrixXd K_;
  VectorXd stage_, next_, dy_ = VectorXd::Zero(K_.rows());
};

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5)
    throw std::runtime_error("usage: pinocchio_peer PROBLEM TABLEAU fixed|adaptive STEPS|TOLERANCE");
  const peers::Problem problem = peers::read_problem(argv[1]);
  const Tableau tableau = read_tableau(argv[2]);
  const bool fixed = std::strcmp(argv[3], "fixed") == 0;
  System system(problem);
  RungeKutta method(system, tableau);
  VectorXd y;
  const double seconds = peers::minimum_seconds([&] { y = system.start(); },
                                                [&] {
                                                  if (fixed)
                                                    method.fixed(y, problem.end, std::atol(argv[4]));
                                                  else
                                                    method.adaptive(y, problem.end, std::atof(argv[4]));
                                                });
  peers::print_result(seconds, system.poses(y));
  return 0;
} catch (const std::exception& fault) {
  std::fprintf(stderr, "%s\n", fault.what());
  return 1;
}
