// The function pre_step_impulses() of project.h: impulses at the start of a step of semi-implicit Euler, so
// that limits, strings and joints, C = 0 of Eq. (12), are satisfied at the end of the step.
#pragma once

#include <pliant/project/project.h>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/math/header_only.h>
#include <pliant/math/max_or_nan.h>
#include <pliant/project/projection.h>

namespace pliant {

namespace projection {

/// The iterations end if an iteration leaves more than this share of the largest gap, because the remaining
/// gaps are then rounding errors.
inline constexpr double kStalledAhead = 0.9;
/// Largest rotation of a part in a step while a joint closes, rad.
inline constexpr double kMaxRotationClosing = 0.2;

/// Changes the velocities of an island of rigid parts on ball joints so that its gaps are closed at the end
/// of the step, and returns true. Returns false if the last evaluation of the island did not use RigidIsland.
/// If the iteration fails, evaluates the island by the general solver and returns false.
inline bool close_ahead_on_rigid_island(StepContext& step, const Island& island, VecX<double>& q_end) {
  RigidWorkspace* rigid = rigid_workspace(island, step.work);
  if (rigid == nullptr) return false;
  const Model& model = step.model();
  State& state = step.state;
  auto advanced = [&]() -> const VecX<double>& {
    for (const int i : island.parts) {
      const PartModel& m = model.parts()[at(i)];
      q_end.segment<7>(m.q0) = state.q.segment<7>(m.q0);
      advance_part(m, q_end, state.v.segment<6>(m.v0), step.h);
    }
    return q_end;
  };
  const BlockFactor<double>& W_c = step.work.joints.W_c[island_index(model, island)].blocks();
  if (model.rigid_islands()[at(island.rigid)].close_ahead(rounding(model), step.h, W_c, *rigid, state.v,
                                                          advanced))
    return true;
  step.dynamics.factor_joints(state.time(), state.q, state.v, state.joints, island, step.work);
  return false;
}

/// Returns whether a joint of an island is closing.
inline bool has_closing_joint(const Island& island, const Workspace<double>& work) {
  return std::any_of(island.joints.begin(), island.joints.end(),
                     [&](int j) { return work.joints.modes[at(j)] == JointMode::closing; });
}

/// Limits the rotation in the step of each part of an island with a closing joint, and returns the work of
/// the change, J. The limit is kMaxRotationClosing, or the rotation with the angular velocity at the start of
/// the step if this rotation is larger. Without the limit, the force of an open joint could make a part
/// oscillate about the joint with growing energy. The velocities of the centres of mass do not change.
/// before: velocities at the start of the step. x: velocities of the group, which are changed. capped:
/// scratch storage.
template <int Max>
double limit_rotations(const Group<double, Max>& group, const VecX<double>& before, double h,
                       VecMax<double, Max>& x, VecMax<double, Max>& capped) {
  capped = x;
  for (int i = 0; i < group.parts(); ++i) {
    auto v_r = group.share(capped, i);
    const double rotation = h * v_r.template segment<3>(3).norm(),
                 max_rotation =
                     std::max(kMaxRotationClosing, h * before.segment<3>(group.model(i).v0 + 3).norm());
    if (!(rotation > max_rotation)) continue;
    const Inertia<double>& inertia = group.workspace(i).inertia;
    const Vec3<double> change = (max_rotation / rotation - 1) * v_r.template segment<3>(3);
    v_r.template head<3>() -= change.cross(Vec3<double>(inertia.moment / inertia.mass));
    v_r.template segment<3>(3) += change;
  }
  const double work = kinetic_change(group, x, capped);
  x = capped;
  return work;
}

/// Returns whether a parameter passes a limit when it moves with its rate for a time h, s.
template <int Max>
bool crosses(const Group<double, Max>& group, double h, const State& state) {
  for (int i = 0; i < group.parts(); ++i) {
    const PartModel& m = group.model(i);
    for (int k = 0; k < m.n_s; ++k)
      if (!m.limits[at(k)].contains(state.q[m.q0 + 7 + k] + h * state.v[m.v0 + 6 + k])) return true;
  }
  return false;
}

/// Sets the limit modes of the parameters of a group to the modes at the end of the step.
template <int Max>
void update_limit_modes(const Group<double, Max>& group, double h, State& state) {
  for (int i = 0; i < group.parts(); ++i) {
    const PartModel& m = group.model(i);
    for (int k = 0; k < m.n_s; ++k) {
      const double q = state.q[m.q0 + 7 + k], q_end = q + h * state.v[m.v0 + 6 + k];
      const Range range = m.limits[at(k)];
      limit_mode(state, m, k) = q_end <= range.min ? -1 : (q_end >= range.max ? 1 : 0);
      // A rate that does not change q in floating-point arithmetic is a rounding error of other impulses, and
      // is set to zero.
      if (limit_mode(state, m, k) != 0 && q_end == q) state.v[m.v0 + 6 + k] = 0;
    }
  }
}

/// The impulses before the step on one group: an island, or a part without joints.
template <int Max>
class PreStep {
 public:
  PreStep(StepContext& step, const Group<double, Max>& group, PreStepStorage& storage)
      : step_(step),
        group_(group),
        island_(group.island()),
        state_(step.state),
        storage_(storage),
        vectors_(group_vectors(group, step.work)) {}

  /// v_start: the velocities at the start of the step.
  void apply(const VecX<double>& v_start) {
    if (island_ != nullptr && sleeps(state_, island_->parts.front())) return;
    if (island_ == nullptr && !crosses(group_, step_.h, state_))
      return update_limit_modes(group_, step_.h, state_);
    if (island_ != nullptr && close_ahead_on_rigid_island(step_, *island_, storage_.q_end)) return;
    gather_velocities(group_, state_.v, vectors_.x);
    if (island_ != nullptr && has_closing_joint(*island_, step_.work)) limit_closing_rotations(v_start);
    vectors_.before = vectors_.x;
    double largest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxIterations; ++i)
      if (!correct(largest) || island_ == nullptr) break;
    update_limit_modes(group_, step_.h, state_);
    for (const auto& [mode, side] : stopped_limits_) *mode = side;
  }

 private:
  void limit_closing_rotations(const VecX<double>& v_start) {
    state_.work[static_cast<int>(Work::baumgarte)] +=
        limit_rotations(group_, v_start, step_.h, vectors_.x, vectors_.before);
    scatter();
  }
  void scatter() {
    for (int i = 0; i < group_.parts(); ++i)
      scatter_velocity(group_.model(i), group_.workspace(i), group_.share(vectors_.x, i), state_.v);
  }

  /// Does one iteration. largest: as for close_gaps(). Returns false if no joint needs a correction and no
  /// one-sided row is violated.
  bool correct(double& largest) {
    const bool open = island_ != nullptr && close_joints_ahead(largest);
    OneSidedRows<Max> rows(group_);
    vectors_.joined = vectors_.x;
    rows.satisfy_all(vectors_.x, [&](const OneSidedRow& row) { return min_velocity(row); });
    if (!rows.empty())
      state_.work[static_cast<int>(Work::limits)] += kinetic_change(group_, vectors_.joined, vectors_.x);
    if (!open && rows.empty()) return false;
    scatter();
    if (!rows.empty())
      step_.counters.limit_impulses += rows.for_each_pushed([&](const OneSidedRow& row, double) {
        if (row.part >= 0)
          stopped_limits_.emplace_back(&limit_mode(state_, group_.model(row.part), row.k),
                                       row.sign > 0 ? -1 : 1);
      });
    return true;
  }

  /// Evaluates the joints at the end of the step. Adds to x the impulses at the start of the step that close
  /// the joints at the end, and returns whether x was changed. The impulses change the displacement h v (the
  /// method SHAKE; Ryckaert, Ciccotti & Berendsen 1977); projection of q alone would change the energy of
  /// rotating parts. largest: as for close_gaps().
  bool close_joints_ahead(double& largest) {
    for (int i = 0; i < group_.parts(); ++i) {
      const PartModel& m = group_.model(i);
      storage_.q_end.segment(m.q0, m.n_q()) = state_.q.segment(m.q0, m.n_q());
      advance_whole_part(m, storage_.q_end, state_.v, step_.h);
    }
    step_.dynamics.evaluate_joints(state_.time() + step_.h, storage_.q_end, state_.v, state_.joints, *island_,
                                   storage_.ahead);
    vectors_.before = vectors_.x;
    return step_.joint_policy().projected && close_gaps(largest);
  }

  /// Adds to x the change that removes the gaps of closed joints at the end of the step. Returns false,
  /// without a change, if these gaps are rounding errors or no longer decrease. largest: on entry the largest
  /// gap of the last iteration, on return the largest gap of this iteration, relative to rounding.
  bool close_gaps(double& largest) {
    VecX<double>& error = vectors_.rows;
    error.setZero(island_->rows);
    const double before = std::exchange(largest, 0);
    for (const int j : island_->joints) {
      const JointModel& joint = step_.model().joints()[at(j)];
      if (state_.joints[at(j)] != JointMode::closed) continue;
      const auto C = storage_.ahead.joints.C.segment(joint.row, joint.rows);
      largest = max_or_nan(C.norm() / rounding(joint, storage_.ahead), largest);
      error.segment(joint.island_row, joint.rows) = C / step_.h;
    }
    if (!(largest > 1) || largest > kStalledAhead * before) return false;
    group_.correct(error, vectors_.x);
    return true;
  }

  /// Returns the smallest velocity of a row that the limits allow; -infinity if the row has no bound. With
  /// this velocity, at the end of the step the parameter is at its limit or the string has its length. If the
  /// string rebounds, the velocity is the velocity of the rebound.
  double min_velocity(const OneSidedRow& row) const {
    if (row.part < 0) {
      const int j = island_->strings[at(row.k)];
      const JointMode mode = state_.joints[at(j)];
      const JointModel& string = step_.model().joints()[at(j)];
      const double C = storage_.ahead.joints.C[string.row];
      if (mode == JointMode::off || mode == JointMode::closing || row.sign < 0 ||
          C > -rounding(string, storage_.ahead))
        return -std::numeric_limits<double>::infinity();
      const double C_dot = storage_.ahead.joints.C_dot[string.row];
      if (rebounds(step_.model(), string, C_dot))
        return group_.value(row, vectors_.before) - (1 + string.joint->restitution()) * C_dot;
      return group_.value(row, vectors_.before) - C / step_.h;
    }
    const Range range = group_.model(row.part).limits[at(row.k)];
    const double q = state_.q[group_.model(row.part).q0 + 7 + row.k];
    return row.sign * ((row.sign > 0 ? range.min : range.max) - q) / step_.h;
  }

  StepContext& step_;
  const Group<double, Max>& group_;
  const Island* island_;
  State& state_;
  PreStepStorage& storage_;
  GroupVectors<double, Max>& vectors_;
  std::vector<std::pair<std::int8_t*, std::int8_t>>
      stopped_limits_;  ///< limit modes of parameters that an impulse stopped, and -1 or 1 for the limit
};

}  // namespace projection

PLIANT_INLINE void pre_step_impulses(StepContext& step, const VecX<double>& v_start,
                                     PreStepStorage& storage) {
  if (!step.model().islands().empty()) storage.q_end.resize(step.state.q.size());
  auto apply = [&](const auto& group) {
    projection::PreStep<std::decay_t<decltype(group)>::kMax>(step, group, storage).apply(v_start);
  };
  projection::for_each_alone(step.model(), step.work, apply);
  projection::for_each_island(step.model(), step.work, apply);
}

PLIANT_INLINE void clamp_to_limits(const Model& model, State& state) {
  for (const PartModel& m : model.parts())
    for (int k = 0; k < m.n_s; ++k) {
      const std::int8_t mode = projection::limit_mode(state, m, k);
      if (mode != 0) state.q[m.q0 + 7 + k] = mode < 0 ? m.limits[at(k)].min : m.limits[at(k)].max;
    }
}

}  // namespace pliant
