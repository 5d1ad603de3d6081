// Function bodies of assemble.h: a sequential quadratic method with a line search on a merit function.
#pragma once

#include <pliant/project/assemble.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>

#include <pliant/body/advance.h>
#include <pliant/body/constraint/one_sided_rows.h>
#include <pliant/body/step_failure.h>
#include <pliant/math/header_only.h>
#include <pliant/math/max_or_nan.h>
#include <pliant/project/project.h>
#include <pliant/project/projection.h>

namespace pliant {

namespace assembly {

/// Largest rotation of a part in one step of the iteration, rad, and largest change of a parameter: relative
/// for lengths, absolute for other parameters.
inline constexpr double kMaxRotation = 0.5, kMaxChange = 0.3;
/// First and smallest cost eps of rigid motion, in units of the smallest ratio of stiffness to inertia.
inline constexpr double kRigidFirst = 1e-6;
/// The shape has converged if the length of a step (rad, see Assembly::step()) is at most kConverged. A
/// relative decrease of the merit below kConverged is regarded as no decrease.
inline constexpr double kConverged = 1e-9;
/// Merits of configurations without gaps are regarded as equal up to this relative difference.
inline constexpr double kEqualMerit = 1e-12;
/// Gap, in lengths of the joint (JointModel::length, the size of its smaller part), that the projection at
/// the start of the run closes without loss of accuracy.
inline constexpr double kProjectedGap = 1e-9;
inline constexpr int kMaxIterations = 400;
/// An island cannot close if more than kPatience successive iterations do not reduce its gap below kProgress
/// times the smallest gap before. If any parameter has a stiffness, the assembly fails only if such
/// iterations do not reduce the merit either. kMaxHalvings: largest number of times that the line search
/// halves a step. kMaxAttempts: largest number of times that one step is computed again with a larger cost of
/// rigid motion.
inline constexpr double kProgress = 0.9;
inline constexpr int kPatience = 40, kMaxHalvings = 5, kMaxAttempts = 10;
/// Largest number of joints that a message names, in addition to the joint with the largest gap.
inline constexpr int kMaxNamed = 8;
/// If a step is longer than kMaxStepSize times the step that kMaxRotation and kMaxChange allow, or does not
/// decrease the merit, the cost of rigid motion is multiplied by kCostIncrease and the step is computed
/// again. This is done only if a parameter has a stiffness and each gap is at most kNearGap lengths of its
/// joint. A step that is accepted at the first attempt without being halved divides the cost by
/// kCostDecrease.
inline constexpr double kMaxStepSize = 2, kNearGap = 2, kCostIncrease = 8, kCostDecrease = 4;

inline constexpr double kInfinite = std::numeric_limits<double>::infinity();

/// The assembly of one island.
class Assembly {
 public:
  Assembly(const Dynamics& dynamics, const Island& island, State& state, Workspace<double>& work)
      : dynamics_(dynamics),
        model_(dynamics.model()),
        island_(island),
        state_(state),
        work_(work),
        modes_(state.joints) {
    for (const int j : island.joints)
      if (modes_[at(j)] != JointMode::off) modes_[at(j)] = JointMode::closed;
    for (const int j : island.strings)
      if (modes_[at(j)] != JointMode::off) modes_[at(j)] = JointMode::slack;
    const double ratio = smallest_stiffness_ratio();
    stiff_ = std::isfinite(ratio);
    eps_ = min_eps_ = kRigidFirst * (stiff_ ? ratio : 1);
  }

  /// Evaluates the joints. Returns the largest gap of the acting joints, in lengths of the joint.
  double gap() {
    dynamics_.evaluate_joints(state_.time(), state_.q, state_.v, modes_, island_, work_);
    double largest = 0;
    for_each_gap(
        [&](int, double gap, const JointModel& joint) { largest = max_or_nan(gap / joint.length, largest); });
    return largest;
  }
  /// Returns the largest gap of the last evaluation, m.
  double gap_in_metres() const {
    double largest = 0;
    for_each_gap([&](int, double gap, const JointModel&) { largest = max_or_nan(gap, largest); });
    return largest;
  }

  /// Returns whether the shape converged within kMaxIterations.
  bool converged() const { return converged_; }

  /// Iterates until the gaps are closed and the shape has converged. Returns the number of iterations; after
  /// kMaxIterations, converged() is false if only the shape has not converged. Throws UnsatisfiableModel if
  /// the gaps do not close, and NumericalFailure if a gap is not finite.
  int run() {
    double best_gap = kInfinite, best_merit = kInfinite, last_penalty = penalty_;
    int since_gap = 0, since_merit = 0;
    for (int i = 0; i < kMaxIterations; ++i) {
      const double now = gap();
      if (!std::isfinite(now))
        throw NumericalFailure("assembly: the gap of a joint is not a finite number", state_.time());
      if (std::exchange(last_penalty, penalty_) != penalty_)
        best_merit = kInfinite;  // merits with another penalty are not comparable
      since_gap = now < kProgress * best_gap ? 0 : since_gap + 1;
      since_merit = merit() < (1 - kConverged) * best_merit ? 0 : since_merit + 1;
      best_gap = std::min(best_gap, now);
      best_merit = std::min(best_merit, merit());
      const bool closed = is_closed();
      if (!closed && since_gap > kPatience && (!stiff_ || since_merit > kPatience)) fail(i);
      // Stop if the remaining changes of gaps and shape are rounding errors.
      if (now <= kProjectedGap && since_merit > kPatience / 4) return i;
      const double moved = step(now);
      if (closed && moved <= kConverged) return i;
    }
    if (gap() > kClosedGap) fail(kMaxIterations);  // the projection at the start closes smaller gaps
    converged_ = false;
    return kMaxIterations;
  }

 private:
  template <class F>
  void for_each_gap(F&& act) const {
    for (const int j : island_.joints) {
      const JointModel& joint = model_.joints()[at(j)];
      if (modes_[at(j)] != JointMode::off)
        act(j, work_.joints.C.segment(joint.row, joint.rows).norm(), joint);
    }
    for (const int j : island_.strings) {
      const JointModel& joint = model_.joints()[at(j)];
      if (modes_[at(j)] != JointMode::off) act(j, std::max(0.0, -work_.joints.C[joint.row]), joint);
    }
  }

  bool is_closed() const {
    bool closed = true;
    for_each_gap([&](int, double gap, const JointModel& joint) {
      closed = closed && gap <= projection::rounding(joint, work_);
    });
    return closed;
  }

  /// Returns the smallest ratio of stiffness to inertia over the parameters; infinite if no parameter has
  /// stiffness.
  double smallest_stiffness_ratio() {
    dynamics_.evaluate_masses(state_.time(), state_.q, state_.v, island_.parts, work_);
    double least = kInfinite;
    for (const int i : island_.parts) {
      const PartModel& m = model_.parts()[at(i)];
      const MatX<double> K = m.part->strain_stiffness(q_s(m));
      for (int k = 0; k < m.n_s; ++k) {
        const double stiffness = K(k, k), inertia = mass_matrix(work_.parts[at(i)])(6 + k, 6 + k);
        if (stiffness > 0 && inertia > 0) least = std::min(least, stiffness / inertia);
      }
    }
    return least;
  }

  /// Sets the metric M + K_s / eps of the parts, with the inertia of rotation multiplied by rotation_cost.
  void make_metric(double rotation_cost) {
    dynamics_.evaluate_masses(state_.time(), state_.q, state_.v, island_.parts, work_);
    for (const int i : island_.parts) {
      const PartModel& m = model_.parts()[at(i)];
      PartWorkspace<double>& w = work_.parts[at(i)];
      w.inertia.M = mass_matrix(w);
      MatX<double>& H = w.inertia.M;
      H.block<3, 3>(3, 3) *= rotation_cost;
      H.bottomRightCorner(m.n_s, m.n_s) += m.part->strain_stiffness(q_s(m)) / eps_;
      w.factor.compute(H, m.inertia_floor);
      w.rigid = nullptr;
      if (w.local) fix_nodes(w);
    }
  }

  /// Gives the nodes of a part a very large inertia in the metric, so that only c, theta and q_s change.
  static void fix_nodes(PartWorkspace<double>& w) {
    constexpr double immovable = 1e12;
    MatX<double>&A = w.local->A, &M = w.inertia.M;
    const Eigen::Index n_r = w.local->H0.rows();
    const MatX<double> H = M;
    M = immovable * H(0, 0) * MatX<double>::Identity(A.rows(), A.cols());  // H(0, 0): the mass of the part
    M.topLeftCorner(n_r, n_r) = H;
    A.setZero();
    for (Eigen::Index k = 0; k < n_r; ++k) {
      VecX<double> column = VecX<double>::Unit(n_r, k);
      w.factor.solve(column);
      A.col(k).head(n_r) = column;
    }
  }

  /// Makes one step. largest: the largest gap, in lengths of its joint. Returns the length of the step, rad:
  /// the largest rotation of a part, or the largest change of a parameter (relative for lengths) times
  /// kMaxRotation / kMaxChange. If rigid motion cannot close the gaps, as in a straight chain that is too
  /// short, the cost of rigid motion rises for some steps, so that the parameters change more.
  double step(double largest) {
    double size = 0;
    for (int attempt = 0;; ++attempt) {
      const bool last = !stiff_ || attempt == kMaxAttempts || largest > kNearGap;
      const Group<double, Eigen::Dynamic> group(model_, work_, island_, false);
      const VecX<double> x = direction(group, largest);
      size = step_size(group, x);
      if (!last && size > kMaxStepSize) {
        eps_ *= kCostIncrease;
        continue;
      }
      const VecX<double> from = state_.q;
      const double before = merit();
      double share = std::min(1.0, 1.0 / size);
      for (int halving = 0;; ++halving, share /= 2) {
        state_.q = from;
        if (halving > 0) gap();  // evaluates the frames again
        move(group, x, share);
        correct_curvature(group);
        if (merit() < before || (is_closed() && merit() <= (1 + kEqualMerit) * before)) {
          if (attempt == 0 && halving == 0) eps_ = std::max(min_eps_, eps_ / kCostDecrease);
          return share * size * kMaxRotation;
        }
        if (halving == kMaxHalvings) break;
      }
      if (last) return share * size * kMaxRotation;
      state_.q = from;
      gap();
      eps_ *= kCostIncrease;
    }
  }

  /// Returns the step of the linearised problem. largest: the largest gap, in lengths of its joint.
  VecX<double> direction(const Group<double, Eigen::Dynamic>& group, double largest) {
    make_metric(1 + largest * largest);
    work_.joints.modes = modes_;
    factor_joints<double>(model_, island_, work_.parts, work_.joints);
    VecX<double> x, rows;
    group.gather(x, [&](int p) { return relaxation(group.model(p), group.workspace(p)); });
    group.joint_rows(x, rows);
    add_gaps(rows);
    const VecX<double>& lambda = group.correct(rows, x);
    if (lambda.size() > 0) penalty_ = std::max(penalty_, 2 * eps_ * lambda.lpNorm<Eigen::Infinity>());
    OneSidedRows<Eigen::Dynamic> one_sided(group);
    one_sided.satisfy_all(x, [&](const OneSidedRow& row) { return bound(group, row); });
    return x;
  }

  /// Closes the gaps that remain after a step because the constraints are curved. Ends when the iteration
  /// converges no longer. Without this second-order correction, steps along curved constraints are short
  /// (Maratos 1978).
  void correct_curvature(const Group<double, Eigen::Dynamic>& group) {
    double before = projection::kMaxGap / projection::kSlow;
    for (double now = gap(); now <= projection::kSlow * before && !is_closed(); now = gap()) {
      before = now;
      VecX<double> x = VecX<double>::Zero(group.size()), rows = VecX<double>::Zero(island_.rows);
      add_gaps(rows);
      group.correct(rows, x);
      move(group, x, 1);
    }
  }
  /// Adds C of all acting joints to their rows.
  void add_gaps(VecX<double>& rows) const {
    for (const int j : island_.joints) {
      const JointModel& joint = model_.joints()[at(j)];
      if (modes_[at(j)] != JointMode::off)
        rows.segment(joint.island_row, joint.rows) += work_.joints.C.segment(joint.row, joint.rows);
    }
  }

  /// Returns the merit: the elastic energy plus the penalty times the sum of all gaps. The penalty is larger
  /// than all joint forces, so that the merit decreases along every step that is short enough.
  double merit() const {
    double sum = 0;
    for_each_gap([&](int, double gap, const JointModel&) { sum += penalty_ * gap; });
    for (const int i : island_.parts) {
      const PartModel& m = model_.parts()[at(i)];
      const VecMax<double> s = stretch(m);
      sum += 0.5 * s.dot(m.part->K_s() * s);
      if (m.part->continuum() != nullptr) sum += m.part->continuum()->energy(*m.part, q_s(m));
    }
    return sum;
  }

  VecMax<double> q_s(const PartModel& m) const { return state_.q.segment(m.q0 + 7, m.n_s); }
  VecMax<double> stretch(const PartModel& m) const { return q_s(m) - m.rest_at(state_.time()); }

  /// Returns the step of a part to its rest parameters, without joints.
  VecX<double> relaxation(const PartModel& m, const PartWorkspace<double>& w) const {
    VecX<double> x = VecX<double>::Zero(m.n_x());
    VecX<double> f = -(m.part->K_s() * stretch(m));
    Counters unused;
    if (m.part->continuum() != nullptr)
      m.part->continuum()->add_force(*m.part, q_s(m), VecMax<double>(VecMax<double>::Zero(m.n_s)), 0, f,
                                     unused);
    x.segment(6, m.n_s) = f / eps_;
    w.solve_mass(x);
    return x;
  }

  /// Returns the smallest change of a one-sided row that the limits and strings allow; -infinity if the row
  /// has no bound.
  double bound(const Group<double, Eigen::Dynamic>& group, const OneSidedRow& row) const {
    if (row.part < 0) {
      const int j = island_.strings[at(row.k)];
      if (row.sign < 0 || modes_[at(j)] == JointMode::off) return -kInfinite;
      return -work_.joints.C[model_.joints()[at(j)].row];
    }
    const PartModel& m = group.model(row.part);
    const Range range = m.limits[at(row.k)];
    return row.sign * ((row.sign > 0 ? range.min : range.max) - state_.q[m.q0 + 7 + row.k]);
  }

  /// Returns the length of a step in units of the largest allowed step.
  double step_size(const Group<double, Eigen::Dynamic>& group, const VecX<double>& x) const {
    double size = 1e-300;
    for (int p = 0; p < group.parts(); ++p) {
      const PartModel& m = group.model(p);
      const auto x_part = group.share(x, p);
      size = std::max(size, x_part.segment<3>(3).norm() / kMaxRotation);
      for (int k = 0; k < m.n_s; ++k) {
        const bool is_length = m.part->parameters().moving(k).spec->quantity == Quantity::length;
        const double scale = is_length ? std::abs(state_.q[m.q0 + 7 + k]) : 1.0;
        size = std::max(size, std::abs(x_part[6 + k]) / (kMaxChange * scale));
      }
    }
    return size;
  }

  /// Moves the parts by a share of a step, and clamps their parameters to their limits.
  void move(const Group<double, Eigen::Dynamic>& group, const VecX<double>& x, double share) {
    for (int p = 0; p < group.parts(); ++p) {
      const PartModel& m = group.model(p);
      advance_part(m, state_.q, world_velocity(group.workspace(p), group.share(x, p).head(6 + m.n_s)), share);
      for (int k = 0; k < m.n_s; ++k) {
        double& q = state_.q[m.q0 + 7 + k];
        const Range range = m.limits[at(k)];
        q = std::clamp(q, range.min, range.max);
      }
    }
  }

  /// Throws the failure of the joint with the largest gap.
  [[noreturn]] void fail(int iterations) const {
    int open = -1;
    double largest = -1;
    for_each_gap([&](int j, double gap, const JointModel& joint) {
      if (gap / joint.length <= largest) return;
      largest = gap / joint.length;
      open = j;
    });
    const Joint& joint = *model_.joints()[at(open)].joint;
    std::ostringstream message;
    message << "assembly: " << joint.type() << " '" << joint.name() << "' cannot close: after " << iterations
            << " iterations it is still open by " << largest * model_.joints()[at(open)].length << " m";
    int others = 0;
    for_each_gap([&](int j, double gap, const JointModel& other) {
      if (j == open || gap <= kClosedGap * other.length || ++others > kMaxNamed) return;
      message << (others == 1 ? ", and with it " : ", ") << other.joint->type() << " '" << other.joint->name()
              << "' by " << gap << " m";
    });
    if (others > kMaxNamed) message << " and others";
    throw UnsatisfiableModel(message.str(), state_.time());
  }

  const Dynamics& dynamics_;
  const Model& model_;
  const Island& island_;
  State& state_;
  Workspace<double>& work_;
  std::vector<JointMode> modes_;  ///< modes of the joints: every acting joint is closed
  double eps_ = 1, min_eps_ = 1;  ///< cost of rigid motion, 1/s^2
  double penalty_ = 0;            ///< penalty of a gap, N
  bool stiff_ = false;            ///< whether any parameter has a stiffness
  bool converged_ = true;         ///< see converged()
};

}  // namespace assembly

PLIANT_INLINE AssemblyReport assemble(const Dynamics& dynamics, State& state) {
  AssemblyReport report;
  Workspace<double> work;
  for (const Island& island : dynamics.model().islands()) {
    assembly::Assembly assembly(dynamics, island, state, work);
    const bool open = assembly.gap() > kClosedGap;
    report.gap_before = std::max(report.gap_before, assembly.gap_in_metres());
    if (open) report.iterations = std::max(report.iterations, assembly.run());
    report.converged = report.converged && assembly.converged();
    assembly.gap();
    report.gap = std::max(report.gap, assembly.gap_in_metres());
  }
  dynamics.model().record_limits(state);
  return report;
}

}  // namespace pliant
