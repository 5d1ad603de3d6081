// The projection of a group of parts onto its joints, C = 0 of Eq. (12) and C_dot = 0, and onto its limits.
// The impulses before a step (pre_step_impulses-inl.h) use the constants and the small functions of this
// file.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <sstream>
#include <utility>

#include <pliant/body/advance.h>
#include <pliant/body/constraint/one_sided_rows.h>
#include <pliant/body/speed_scale.h>
#include <pliant/body/step_failure.h>
#include <pliant/math/index.h>
#include <pliant/math/max_or_nan.h>
#include <pliant/project/project.h>

namespace pliant::projection {

/// A gap is a rounding error up to kResidual times the length of the joint (JointModel::length) plus
/// kRounding times the size of the coordinates, see rounding().
inline constexpr double kResidual = 1e-13, kRounding = 4e-15;
/// If an iteration leaves more than the share kSlow of the error, the next iteration uses a new factorisation
/// of C_q M^-1 C_q^T. If an iteration with a new factorisation leaves more than the share kStalled, the
/// remaining error is a rounding error of the rows.
inline constexpr double kSlow = 0.1, kStalled = 0.5;
inline constexpr int kMaxIterations = 30;
/// The projection cannot close a joint if its gap afterwards is above this multiple of rounding().
inline constexpr double kOpenGap = 1e3;
/// Largest number of joints that a message names.
inline constexpr int kMaxNamed = 8;
/// A row depends on the rows of another joint if a unit force on the row causes reactions of the other joint
/// above this share of all reactions.
inline constexpr double kDependentShare = 1e-6;
/// Largest gap, in sizes of the smaller part of the joint, at which a joint can become closed. If a
/// projection fails and the gap before it was larger, the step is reported as too long.
inline constexpr double kMaxGap = 0.1;
/// A joint cannot close if other joints contradict it, and its gap is above kStuckGap lengths of the joint
/// after it has acted for a time of kPatience / beta. beta: Baumgarte's factor, 1/s.
inline constexpr double kStuckGap = 1e-5, kPatience = 10;
/// A projection that decides anew which rows are dependent (RankRule::decide or rounding) is rejected if it
/// moves the parts by more than this share of their motion in the step.
inline constexpr double kMaxUndoneShare = 0.25;
/// A string is taut if the distance of its ends is at least its length minus this number times
/// JointModel::length.
inline constexpr double kTaut = 1e-9;

/// A one-sided joint does not rebound if the magnitude of its rate C_dot is at most this number, in units of
/// the length of the joint (JointModel::length) times Stabilization::rate.
inline constexpr double kMinRebound = 1e-3;

/// Returns whether a one-sided joint that stops a motion with the rate C_dot (m/s) rebounds.
inline bool rebounds(const Model& model, const JointModel& joint, double C_dot) {
  return joint.joint->restitution() > 0 &&
         -C_dot > kMinRebound * joint.length * model.body().stabilization.rate;
}

/// Returns the gap of a joint, m, up to which a gap is a rounding error.
inline double rounding(const JointModel& joint, const Workspace<double>& work) {
  double size = 0;
  for (const JointSide& side : joint.sides)
    size = std::max(size, work.parts[at(side.part)].c.template lpNorm<Eigen::Infinity>());
  return kResidual * joint.length + kRounding * size;
}

/// Returns the allowed gaps of rigid islands.
inline RigidIsland::Rounding rounding(const Model& model) {
  return {kResidual, kRounding, model.body().stabilization.rate};
}
/// Returns the index of an island in the model.
inline std::size_t island_index(const Model& model, const Island& island) {
  return static_cast<std::size_t>(&island - model.islands().data());
}
/// Returns the rigid workspace of an island, or nullptr if the last evaluation of the island did not use it.
inline RigidWorkspace* rigid_workspace(const Island& island, Workspace<double>& work) {
  if (island.rigid < 0 || work.rigid.empty() || !work.rigid[at(island.rigid)].used) return nullptr;
  return &work.rigid[at(island.rigid)];
}

/// Returns the limit mode of parameter k of a part: -1 at the lower limit, 1 at the upper, 0 between.
inline std::int8_t& limit_mode(State& state, const PartModel& m, int k) {
  return state.at_limit[at(m.limit0 + k)];
}

/// Returns the vectors in the workspace for a group: an island, or a part without joints.
template <int Max>
GroupVectors<double, Max>& group_vectors(const Group<double, Max>& group, Workspace<double>& work) {
  if constexpr (Max == Eigen::Dynamic)
    return work.joints.vectors[group.number()];
  else
    return work.alone;
}

/// Gathers the velocities x of a group from v.
template <int Max>
void gather_velocities(const Group<double, Max>& group, const VecX<double>& v, VecMax<double, Max>& x) {
  x.resize(group.size());
  for (int i = 0; i < group.parts(); ++i)
    gather_velocity(group.model(i), group.workspace(i), v, group.share(x, i));
}

/// Returns the change of the kinetic energy of a group from velocities x to y, J.
template <int Max>
double kinetic_change(const Group<double, Max>& group, const VecMax<double, Max>& x,
                      const VecMax<double, Max>& y) {
  double sum = 0;
  for (int i = 0; i < group.parts(); ++i) {
    const MatX<double>& M = group.workspace(i).M();
    const auto before = group.share(x, i), after = group.share(y, i);
    for (Eigen::Index k = 0; k < M.cols(); ++k)
      sum += 0.5 * (before[k] + after[k]) * M.col(k).dot(after - before);
    const double stiffening = group.workspace(i).stiffening;
    if (stiffening == 0) continue;
    const int n_s = group.model(i).n_s;
    sum -= 0.5 * stiffening *
           (before + after).tail(n_s).dot(group.model(i).part->K_s() * (after - before).tail(n_s));
  }
  return sum;
}

/// for_each_alone() calls act(group) for every part with dynamic parameters and without joints.
/// for_each_island() calls act(group) for every island.
template <class F>
void for_each_alone(const Model& model, Workspace<double>& work, F&& act) {
  for (int i = 0; i < static_cast<int>(model.parts().size()); ++i) {
    const PartModel& m = model.parts()[at(i)];
    if (m.q0 >= 0 && m.island < 0 && m.n_s > 0) act(Group<double, kMaxVelocities>(model, work, i));
  }
}
template <class F>
void for_each_island(const Model& model, Workspace<double>& work, F&& act) {
  for (const Island& island : model.islands()) act(Group<double, Eigen::Dynamic>(model, work, island, true));
}

/// Projects coordinates and velocities of a group onto its joints and limits.
template <int Max>
class Projection {
 public:
  using Vector = VecMax<double, Max>;

  /// vectors: storage; coordinates() reads vectors.q.
  Projection(StepContext& step, const Group<double, Max>& group, GroupVectors<double, Max>& vectors)
      : step_(step),
        model_(step.model()),
        group_(group),
        island_(group.island()),
        state_(step.state),
        work_(step.work),
        vectors_(vectors) {}

  /// Projects the coordinates onto C = 0 and the limits. vectors.q: the coordinates before the projection.
  /// Returns whether a limit or a string pushed that was not active before (remains_active()). Throws
  /// UnsatisfiableModel if joints contradict each other, or NumericalFailure if the step opened a joint by
  /// more than kMaxGap.
  bool coordinates() {
    // Rows that were dependent at the start of the step are dependent now, unless the step passes a singular
    // configuration. Joints contradict each other if they could only close by undoing the step.
    std::optional<UnsatisfiableModel> failure;
    for (const RankRule rank : {RankRule::keep, RankRule::decide, RankRule::rounding}) {
      rank_ = rank;
      const bool pushed = iterate_coordinates();
      if (island_ == nullptr || !step_.joint_policy().projected) return pushed;
      std::optional<UnsatisfiableModel> open = open_joint();
      if (!open && (rank == RankRule::keep || !undoes_motion())) return pushed;
      if (open && rank != RankRule::rounding) failure = std::move(open);
      for_each_coordinates([](auto&& stored, auto&& now) { now = stored; });
      evaluated_ = false;
    }
    if (initial_gap_ <= kMaxGap) throw *failure;
    std::ostringstream message;
    message << "the step is too long for the motion: it opens "
            << model_.joints()[at(widest_joint_)].joint->type() << " '"
            << model_.joints()[at(widest_joint_)].joint->name() << "' by " << initial_gap_
            << " times the size of its smaller part";
    if (model_.joints()[at(widest_joint_)].driven)
      message << "; check that the prescribed path of its end does not jump";
    throw NumericalFailure(message.str(), step_.t);
  }

  /// Forgets the last evaluation, because the state has changed.
  void forget() { evaluated_ = false; }
  /// Makes velocities() add its impulses on the rows of all joints, N s, to `impulses`.
  void add_impulses_to(VecX<double>& impulses) { impulses_ = &impulses; }

  /// Projects the velocities onto C_dot = 0; the rate of a parameter at a limit, or of a taut string, may
  /// only lead away from the bound. Sets State::at_limit of the group, and sets parameters that have passed a
  /// limit exactly to the limit. Returns the number of impulses on one-sided rows that were not active
  /// before. Adds the work (J) of the impulses of the joints to `joints`, and the work of the impulses of the
  /// one-sided rows to `one_sided`.
  int velocities(double& joints, double& one_sided) {
    rank_ = RankRule::decide;
    int impulses = 0;
    for (int i = 0; i < group_.parts(); ++i) {
      const PartModel& m = group_.model(i);
      for (int k = 0; k < m.n_s; ++k) {
        const Range range = m.limits[at(k)];
        double& q = state_.q[m.q0 + 7 + k];
        const int mode = q <= range.min ? -1 : (q >= range.max ? 1 : 0);
        limit_mode(state_, m, k) = static_cast<std::int8_t>(mode);
        if (mode == 0) continue;
        q = mode < 0 ? range.min : range.max;
        evaluated_ = false;
      }
    }
    for (int i = 0; i < kMaxIterations; ++i) {
      Vector &before = vectors_.before, &joined = vectors_.joined, &x = vectors_.x;
      gather_velocities(group_, state_.v, before);
      x = before;
      const bool open = correct_joints(Rows::velocities, i, x);
      joined = x;
      OneSidedRows<Max> rows(group_);
      rows.satisfy_all(x, [&](const OneSidedRow& row) { return min_velocity(row, before); });
      if (!open && rows.empty()) break;
      joints += kinetic_change(group_, before, joined);
      one_sided += kinetic_change(group_, joined, x);
      for (int p = 0; p < group_.parts(); ++p)
        scatter_velocity(group_.model(p), group_.workspace(p), group_.share(x, p), state_.v);
      evaluated_ = false;
      if (!rows.empty())
        rows.for_each_pushed([&](const OneSidedRow& row, double push) {
          impulses += remains_active(row) ? 0 : 1;
          if (impulses_ != nullptr) add_one_sided_impulse(row, push);
        });
      if (island_ == nullptr) break;
    }
    for (int i = 0; i < group_.parts(); ++i) {
      const PartModel& m = group_.model(i);
      for (int k = 0; k < m.n_s; ++k)
        if (limit_mode(state_, m, k) * state_.v[m.v0 + 6 + k] < 0)
          limit_mode(state_, m, k) = 0;  // the parameter leaves the limit
    }
    return impulses;
  }

  /// Returns the failure of a joint that is open by a gap (m) and cannot close, with the names of the joints
  /// that keep it open. open: number of the joint. dependent: number of the joint with the dependent rows:
  /// `open`, or a joint that contradicts this joint.
  UnsatisfiableModel contradiction(int open, double gap, int dependent) const {
    const JointModel& joint = model_.joints()[at(open)];
    std::ostringstream message;
    message << "joints contradict each other at t = " << step_.t << " s: " << joint.joint->type() << " '"
            << joint.joint->name() << "' stays open by " << gap << " m";
    int named = 0;
    auto name = [&](int j) {
      message << (++named == 1 ? ", held open by " : ", ") << model_.joints()[at(j)].joint->type() << " '"
              << model_.joints()[at(j)].joint->name() << "'";
    };
    if (dependent != open && model_.joints()[at(dependent)].joint->one_sided()) name(dependent);
    for (const int j : island_->strings)
      if (j != open && j != dependent && model_.joints()[at(open)].joint->one_sided() && is_taut(j)) name(j);
    for (const int j : island_->joints) {
      if (j == open || (j != dependent && !depends(model_.joints()[at(dependent)], model_.joints()[at(j)])))
        continue;
      if (named == kMaxNamed) {
        message << " and others";
        break;
      }
      name(j);
    }
    return UnsatisfiableModel(message.str(), step_.t);
  }

 private:
  enum class Rows { coordinates, velocities };

  /// Whether a string acts and is not slack.
  bool is_taut(int j) const {
    const JointModel& joint = model_.joints()[at(j)];
    return state_.joints[at(j)] == JointMode::closed && work_.joints.C[joint.row] <= kTaut * joint.length;
  }

  /// Iterates until the joints are closed to rounding. Returns whether a limit or a string pushed
  /// that was not active before (remains_active()).
  bool iterate_coordinates() {
    new_factor_ = false;
    pulled_strings_.clear();
    bool pushed = false;
    for (int i = 0; i < kMaxIterations; ++i) {
      Vector& x = vectors_.x;
      x.setZero(group_.size());
      const bool open = correct_joints(Rows::coordinates, i, x);
      OneSidedRows<Max> rows(group_);
      rows.satisfy_all(x, [&](const OneSidedRow& row) { return min_change(row); });
      if (!open && rows.empty()) return pushed;
      for (int p = 0; p < group_.parts(); ++p)
        advance_part_in_group(group_.model(p), group_.workspace(p), group_.share(x, p), 1, state_.q);
      evaluated_ = false;
      if (!rows.empty())
        rows.for_each_pushed([&](const OneSidedRow& row, double) {
          pushed = pushed || !remains_active(row);
          if (row.part < 0) {
            mark_pulled(row.k);
            return;
          }
          const PartModel& m = group_.model(row.part);
          double& q = state_.q[m.q0 + 7 + row.k];
          const Range range = m.limits[at(row.k)];
          q = std::abs(q - range.min) < std::abs(q - range.max) ? range.min : range.max;
        });
      if (island_ == nullptr) return pushed;
    }
    return pushed;
  }

  /// Calls act(stored coordinates, coordinates of the state) for each part.
  template <class F>
  void for_each_coordinates(F&& act) const {
    int first = 0;
    for (int i = 0; i < group_.parts(); ++i) {
      const PartModel& m = group_.model(i);
      act(vectors_.q.segment(first, m.n_q()), state_.q.segment(m.q0, m.n_q()));
      first += m.n_q();
    }
  }
  /// Returns whether the projection moved the parts by more than kMaxUndoneShare of their motion in the step.
  bool undoes_motion() const {
    double correction = 0, motion = 0;
    int i = 0;
    for_each_coordinates([&](const auto& stored, const auto& now) {
      const PartModel& m = group_.model(i++);
      const double size = m.size;
      const auto v = part_velocities(m, std::as_const(state_.v));
      correction +=
          (stored.template head<3>() - now.template head<3>()).squaredNorm() +
          4 * size * size * (stored.template segment<4>(3) - now.template segment<4>(3)).squaredNorm();
      motion += v.template head<3>().squaredNorm() + size * size * v.template segment<3>(3).squaredNorm();
    });
    return correction > kMaxUndoneShare * kMaxUndoneShare * state_.h * state_.h * motion;
  }

  /// Returns the rounding of the rows of a joint, m for coordinates and m/s for velocities.
  double row_rounding(const JointModel& joint, Rows kind) const {
    if (kind == Rows::coordinates) return rounding(joint, work_);
    double size = 0;
    for (const JointSide& side : joint.sides)
      size = std::max(size, largest_speed(model_.parts()[at(side.part)], work_.parts[at(side.part)].v_r));
    return kResidual * model_.body().stabilization.rate * joint.length + kRounding * size;
  }

  /// Adds the impulse of a one-sided row, and the reactions of the joints, to the impulses.
  void add_one_sided_impulse(const OneSidedRow& row, double push) {
    if (row.part < 0) (*impulses_)[model_.joints()[at(island_->strings[at(row.k)])].row] += row.sign * push;
    Vector x = group_.push(row);
    VecX<double> rows;
    group_.joint_rows(x, rows);
    add_impulses(group_.correct(rows, x), push);
  }
  /// Adds factor * lambda, of the joints of the island, to the impulses.
  void add_impulses(const VecX<double>& lambda, double factor) {
    for (const int j : island_->joints) {
      const JointModel& joint = model_.joints()[at(j)];
      impulses_->segment(joint.row, joint.rows) += factor * lambda.segment(joint.island_row, joint.rows);
    }
  }

  /// Evaluates the joints and adds to x the change that zeroes the rows of closed joints. Returns false if
  /// these rows are zero to rounding, or if an iteration no longer reduces them. Also returns false for a
  /// part without joints, and if joints are not projected.
  bool correct_joints(Rows kind, int iteration, Vector& x) {
    if (island_ == nullptr) return false;
    evaluate(kind, iteration, x);
    if (!step_.joint_policy().projected) return false;
    const VecX<double>& rows = kind == Rows::coordinates ? work_.joints.C : work_.joints.C_dot;
    double now = 0;
    VecX<double>& error = vectors_.rows;
    error.setZero(island_->rows);
    for (const int j : island_->joints) {
      const JointModel& joint = model_.joints()[at(j)];
      if (state_.joints[at(j)] != JointMode::closed) continue;
      auto row = error.segment(joint.island_row, joint.rows);
      row = rows.segment(joint.row, joint.rows);
      if (linear_update_) row += vectors_.gained.segment(joint.island_row, joint.rows);
      if (iteration == 0 && rank_ == RankRule::keep && !(row.norm() <= initial_gap_ * joint.length)) {
        initial_gap_ = row.norm() / joint.length;
        widest_joint_ = j;
      }
      now = max_or_nan(row.norm() / row_rounding(joint, kind), now);
    }
    if (!(now > 1)) return false;
    const bool slow = iteration > 0 && now > kSlow * last_error_;
    if (slow && new_factor_ && now > kStalled * last_error_) return false;
    new_factor_ = slow || (iteration == 0 && kind == Rows::coordinates && rank_ != RankRule::keep);
    if (new_factor_) {
      step_.dynamics.factor_joints(step_.t, state_.q, state_.v, state_.joints, *island_, work_, rank_);
      vectors_.start = x;
    }
    last_error_ = now;
    const VecX<double>& lambda = group_.correct(error, x);
    if (impulses_ != nullptr && kind == Rows::velocities) add_impulses(lambda, 1);
    return true;
  }

  /// Evaluates the joints at the state. In islands without strings, the change of C_dot by new velocities
  /// follows from C_q alone.
  void evaluate(Rows kind, int iteration, const Vector& x) {
    linear_update_ = kind == Rows::velocities && iteration > 0 && island_->strings.empty();
    if (linear_update_) {
      vectors_.gain = x - vectors_.start;
      group_.joint_rows(vectors_.gain, vectors_.gained);
      return;
    }
    if (!evaluated_)
      step_.dynamics.evaluate_joints(step_.t, state_.q, state_.v, state_.joints, *island_, work_);
    evaluated_ = true;
    if (kind == Rows::velocities) vectors_.start = x;
  }

  /// Returns the failure of a closed joint with a gap above rounding, or of a string that is too long, with
  /// the names of the joints that keep it open; std::nullopt if there is no such joint or string.
  std::optional<UnsatisfiableModel> open_joint() {
    if (!evaluated_ && !island_->strings.empty())
      step_.dynamics.evaluate_joints(step_.t, state_.q, state_.v, state_.joints, *island_, work_);
    int open = -1;
    double widest = 0;
    auto consider = [&](int j, double gap, double allowed) {
      if (state_.joints[at(j)] != JointMode::closed || !(gap > allowed) || gap <= widest) return;
      if (!std::isfinite(gap)) return;  // the check for a finite state reports this failure
      open = j;
      widest = gap;
    };
    for (const int j : island_->joints) {
      const JointModel& joint = model_.joints()[at(j)];
      consider(j, work_.joints.C.segment(joint.row, joint.rows).norm(),
               kOpenGap * row_rounding(joint, Rows::coordinates));
    }
    for (const int j : island_->strings) {
      const JointModel& joint = model_.joints()[at(j)];
      consider(j, -work_.joints.C[joint.row], kStuckGap * joint.length);
    }
    if (open < 0) return std::nullopt;
    return contradiction(open, widest, open);
  }

  /// Returns whether the rows of a joint depend on the rows of another joint.
  bool depends(const JointModel& joint, const JointModel& other) const {
    for (int r = 0; r < joint.rows; ++r) {
      Vector x = Vector::Zero(group_.size());
      for (const JointSide& side : joint.sides) {
        const int n = static_cast<int>(group_.share(x, side.place).size());
        VecX<double> force = work_.joints.Cq.segment(side.offset + r * n, n);
        group_.workspace(side.place).solve_mass(force);
        group_.share(x, side.place) += force;
      }
      Vector unused = x;
      VecX<double> rows;
      group_.joint_rows(x, rows);
      const VecX<double>& share = group_.correct(rows, unused);
      const auto other_share = share.segment(other.island_row, other.rows);
      if (other_share.norm() > kDependentShare * share.norm()) return true;
    }
    return false;
  }

  /// Returns whether a one-sided row stays active: the last evaluation pushed on this row or on the opposite
  /// row. A string must also have the mode JointMode::closed. Always false for a part without joints.
  bool remains_active(const OneSidedRow& row) const {
    if (island_ == nullptr) return false;
    if (row.part < 0 && state_.joints[at(island_->strings[at(row.k)])] != JointMode::closed) return false;
    const auto& pushed = work_.joints.pushed[island_index(model_, *island_)];
    return std::any_of(pushed.begin(), pushed.end(),
                       [&](const OneSidedRow& p) { return p.part == row.part && p.k == row.k; });
  }

  /// Marks a string that this projection has pulled. Further iterations keep the string at its length.
  void mark_pulled(int k) {
    if (!was_pulled(k)) pulled_strings_.push_back(k);
  }
  bool was_pulled(int k) const {
    return std::find(pulled_strings_.begin(), pulled_strings_.end(), k) != pulled_strings_.end();
  }

  static constexpr double kUnbounded = -std::numeric_limits<double>::infinity();

  /// Returns the smallest change of a row that limits and strings allow; kUnbounded if there is no bound.
  double min_change(const OneSidedRow& row) const {
    if (row.part < 0) {
      const int j = island_->strings[at(row.k)];
      const JointMode mode = state_.joints[at(j)];
      if (mode == JointMode::off || mode == JointMode::closing) return kUnbounded;
      const JointModel& string = model_.joints()[at(j)];
      const double C = work_.joints.C[string.row], rounding = row_rounding(string, Rows::coordinates);
      const bool tight = remains_active(row) || was_pulled(row.k);
      if (std::abs(C) <= rounding) return tight ? 0 : (row.sign > 0 ? -rounding : kUnbounded);
      return row.sign > 0 || tight ? -row.sign * C : kUnbounded;
    }
    const PartModel& m = group_.model(row.part);
    const double q = state_.q[m.q0 + 7 + row.k];
    const Range range = m.limits[at(row.k)];
    if (remains_active(row) && limit_mode(state_, m, row.k) != 0)
      return row.sign * ((limit_mode(state_, m, row.k) < 0 ? range.min : range.max) - q);
    return row.sign * ((row.sign > 0 ? range.min : range.max) - q);
  }

  /// Returns the smallest velocity of a row that limits and strings allow; kUnbounded if there is no bound.
  double min_velocity(const OneSidedRow& row, const Vector& v) const {
    if (row.part < 0) {
      const int j = island_->strings[at(row.k)];
      const JointModel& string = model_.joints()[at(j)];
      const JointMode mode = state_.joints[at(j)];
      if (mode == JointMode::off || mode == JointMode::closing) return kUnbounded;
      if (work_.joints.C[string.row] > kTaut * string.length && !remains_active(row)) return kUnbounded;
      if (row.sign < 0 && !remains_active(row)) return kUnbounded;
      const double C_dot = work_.joints.C_dot[string.row];
      if (std::abs(C_dot) <= row_rounding(string, Rows::velocities)) return kUnbounded;
      if (!remains_active(row) && rebounds(model_, string, C_dot))
        return group_.value(row, v) - (1 + string.joint->restitution()) * C_dot;
      return group_.value(row, v) - row.sign * C_dot;
    }
    const int mode = limit_mode(state_, group_.model(row.part), row.k);
    return mode != 0 && (mode * row.sign < 0 || remains_active(row)) ? 0 : kUnbounded;
  }

  StepContext& step_;
  const Model& model_;
  const Group<double, Max>& group_;
  const Island* island_;
  State& state_;
  Workspace<double>& work_;
  GroupVectors<double, Max>& vectors_;
  VecX<double>* impulses_ = nullptr;
  double last_error_ = 0;
  RankRule rank_ = RankRule::keep;
  double initial_gap_ =
      0;  ///< largest gap of the closed joints before the projection, in lengths of the joint
  int widest_joint_ = -1;            ///< number of the joint with the largest gap
  bool evaluated_ = false;           ///< whether the joints were evaluated at the current state
  bool linear_update_ = false;       ///< whether C_dot follows from an evaluation at earlier velocities
  bool new_factor_ = false;          ///< whether the last correction used a new factorisation
  std::vector<int> pulled_strings_;  ///< see mark_pulled()
};

}  // namespace pliant::projection
