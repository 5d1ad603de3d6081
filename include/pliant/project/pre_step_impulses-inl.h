// Impulses before the coordinates move by h v, so that limits, strings and joints are met at the end of the
// step.
#pragma once

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/math/header_only.h>
#include <pliant/project/projection.h>

namespace pliant {

namespace projection {

/// The iteration ends at rounding: when the gaps shrink by less than this factor.
inline constexpr double kIdle = 0.9;
/// Largest rotation of a part in a step while a joint closes, rad.
inline constexpr double kMaxTurnClosing = 0.2;

/// Closes an island whose last evaluation was that of a rigid island. If that fails, evaluates the island the
/// general way and returns false.
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
  const BlockFactor<double>& W_c = step.work.joints.W_c[number_of(model, island)].blocks();
  if (model.rigid_islands()[at(island.rigid)].close_ahead(rounding(model), step.h, W_c, *rigid, state.v,
                                                          advanced))
    return true;
  step.dynamics.factor_joints(state.time(), state.q, state.v, state.joints, island, step.work);
  return false;
}

inline bool any_closing(const Island& island, const Workspace<double>& work) {
  return std::any_of(island.joints.begin(), island.joints.end(),
                     [&](int j) { return work.joints.modes[at(j)] == JointMode::closing; });
}

/// Limits the rotation of parts of a closing island to kMaxTurnClosing in the step. The pull of an open joint
/// may make a part swing about it for long, which gains energy in each step. The centres of mass keep their
/// velocities. before: velocities at the start of the step. Returns the work of the change.
template <int Max>
double cap_turns(const Group<double, Max>& group, const VecX<double>& before, double h,
                 VecMax<double, Max>& x, VecMax<double, Max>& capped) {
  capped = x;
  for (int i = 0; i < group.parts(); ++i) {
    auto v_r = group.share(capped, i);
    const double turn = h * v_r.template segment<3>(3).norm(),
                 most = std::max(kMaxTurnClosing, h * before.segment<3>(group.model(i).v0 + 3).norm());
    if (!(turn > most)) continue;
    const Inertia<double>& inertia = group.workspace(i).inertia;
    const Vec3<double> change = (most / turn - 1) * v_r.template segment<3>(3);
    v_r.template head<3>() -= change.cross(Vec3<double>(inertia.moment / inertia.mass));
    v_r.template segment<3>(3) += change;
  }
  const double work = kinetic_change(group, x, capped);
  x = capped;
  return work;
}

/// Returns whether a parameter passes a limit when it moves for a time h.
template <int Max>
bool crosses(const Group<double, Max>& group, double h, const State& state) {
  for (int i = 0; i < group.parts(); ++i) {
    const PartModel& m = group.model(i);
    for (int k = 0; k < m.n_s; ++k)
      if (!m.limits[at(k)].contains(state.q[m.q0 + 7 + k] + h * state.v[m.v0 + 6 + k])) return true;
  }
  return false;
}

/// Sets the limit modes of the parameters of a group at the end of the step.
template <int Max>
void note_limits(const Group<double, Max>& group, double h, State& state) {
  for (int i = 0; i < group.parts(); ++i) {
    const PartModel& m = group.model(i);
    for (int k = 0; k < m.n_s; ++k) {
      const double q = state.q[m.q0 + 7 + k], then = q + h * state.v[m.v0 + 6 + k];
      const Range range = m.limits[at(k)];
      limit_mode(state, m, k) = then <= range.min ? -1 : (then >= range.max ? 1 : 0);
      // A rate too small to leave the limit is rounding of other impulses: it is set to zero.
      if (limit_mode(state, m, k) != 0 && then == q) state.v[m.v0 + 6 + k] = 0;
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
        kept_(kept_vectors(group, step.work)) {}

  /// v_start: the velocities at the start of the step.
  void apply(const VecX<double>& v_start) {
    if (island_ != nullptr && sleeps(state_, island_->parts.front())) return;
    if (island_ == nullptr && !crosses(group_, step_.h, state_)) return note_limits(group_, step_.h, state_);
    if (island_ != nullptr && close_ahead_on_rigid_island(step_, *island_, storage_.q_end)) return;
    gather_velocities(group_, state_.v, kept_.x);
    if (island_ != nullptr && any_closing(*island_, step_.work)) cap_turns_of_closing(v_start);
    kept_.before = kept_.x;
    double widest = std::numeric_limits<double>::infinity();
    for (int i = 0; i < kMaxIterations; ++i)
      if (!correct(widest) || island_ == nullptr) break;
    note_limits(group_, step_.h, state_);
    for (const auto& [mode, side] : stopped_) *mode = side;
  }

 private:
  void cap_turns_of_closing(const VecX<double>& v_start) {
    state_.work[static_cast<int>(Work::baumgarte)] +=
        cap_turns(group_, v_start, step_.h, kept_.x, kept_.before);
    scatter();
  }
  void scatter() {
    for (int i = 0; i < group_.parts(); ++i)
      scatter_velocity(group_.model(i), group_.workspace(i), group_.share(kept_.x, i), state_.v);
  }

  /// One iteration. Returns false if no joint is open and no one-sided row pushes.
  bool correct(double& widest) {
    const bool open = island_ != nullptr && close_joints_ahead(widest);
    OneSidedRows<Max> rows(group_);
    kept_.joined = kept_.x;
    rows.meet_all(kept_.x, [&](const OneSidedRow& row) { return slowest(row); });
    if (!rows.empty())
      state_.work[static_cast<int>(Work::limits)] += kinetic_change(group_, kept_.joined, kept_.x);
    if (!open && rows.empty()) return false;
    scatter();
    if (!rows.empty())
      step_.counters.limit_impulses += rows.for_each_pushed([&](const OneSidedRow& row, double) {
        if (row.part >= 0)
          stopped_.emplace_back(&limit_mode(state_, group_.model(row.part), row.k), row.sign > 0 ? -1 : 1);
      });
    return true;
  }

  /// Impulses at the start of the step that close the joints at its end: h v is projected, not q alone, which
  /// keeps the energy of turning parts (the method SHAKE; Ryckaert, Ciccotti & Berendsen 1977). Returns
  /// whether joints were open.
  bool close_joints_ahead(double& widest) {
    for (int i = 0; i < group_.parts(); ++i) {
      const PartModel& m = group_.model(i);
      storage_.q_end.segment(m.q0, m.n_q()) = state_.q.segment(m.q0, m.n_q());
      advance_whole_part(m, storage_.q_end, state_.v, step_.h);
    }
    step_.dynamics.evaluate_joints(state_.time() + step_.h, storage_.q_end, state_.v, state_.joints, *island_,
                                   storage_.ahead);
    kept_.before = kept_.x;
    return step_.joint_policy().projected && close_gaps(widest);
  }

  /// Adds to x the change that removes the gaps of closed joints at the end of the step. Returns false if
  /// they are closed there to rounding. widest: the widest gap of the last iteration, then of this one.
  bool close_gaps(double& widest) {
    VecX<double>& error = kept_.rows;
    error.setZero(island_->rows);
    const double before = std::exchange(widest, 0);
    for (const int j : island_->joints) {
      const JointModel& joint = step_.model().joints()[at(j)];
      if (state_.joints[at(j)] != JointMode::closed) continue;
      const auto C = storage_.ahead.joints.C.segment(joint.row, joint.rows);
      widest = wider(C.norm() / rounding(joint, storage_.ahead), widest);
      error.segment(joint.island_row, joint.rows) = C / step_.h;
    }
    if (!(widest > 1) || widest > kIdle * before) return false;
    group_.correct(error, kept_.x);
    return true;
  }

  /// Returns the smallest velocity of a row: with it the limit, or the length of the string, is just reached
  /// at the end of the step.
  double slowest(const OneSidedRow& row) const {
    if (row.part < 0) {
      const int j = island_->strings[at(row.k)];
      const JointMode mode = state_.joints[at(j)];
      const JointModel& string = step_.model().joints()[at(j)];
      const double C = storage_.ahead.joints.C[string.row];
      if (mode == JointMode::off || mode == JointMode::closing || row.sign < 0 ||
          C > -rounding(string, storage_.ahead))
        return -std::numeric_limits<double>::infinity();
      return group_.value(row, kept_.before) - C / step_.h;
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
  GroupVectors<double, Max>& kept_;
  std::vector<std::pair<std::int8_t*, std::int8_t>>
      stopped_;  ///< limits that an impulse stopped at, with the side
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
