// The functions project_joints(), project_limits() and engage_joints() of project.h: joints and strings
// become closed or taut, and groups are projected onto joints, C = 0 of Eq. (12), and limits.
#pragma once

#include <pliant/project/project.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <Eigen/Cholesky>

#include <pliant/body/stages/part_stages.h>
#include <pliant/math/finite.h>
#include <pliant/math/header_only.h>
#include <pliant/math/scalar/power_of_two.h>
#include <pliant/project/projection.h>

namespace pliant {

namespace projection {

/// Stores the coordinates and velocities of a group.
template <int Max>
class Snapshot {
 public:
  Snapshot(const Group<double, Max>& group, State& state, GroupVectors<double, Max>& vectors)
      : group_(group), vectors_(vectors) {
    int n_q = 0, n_v = 0;
    for (int i = 0; i < group.parts(); ++i) {
      n_q += group.model(i).n_q();
      n_v += group.model(i).n_v();
    }
    vectors_.q.resize(n_q);
    vectors_.v.resize(n_v);
    exchange(state, [](auto&& stored, auto&& now) { stored = now; });
  }
  /// Exchanges the stored values with the values of the state.
  void swap(State& state) {
    exchange(state, [](auto&& stored, auto&& now) { stored.swap(now); });
  }

 private:
  template <class F>
  void exchange(State& state, F&& act) {
    int q = 0, v = 0;
    for (int i = 0; i < group_.parts(); ++i) {
      const PartModel& m = group_.model(i);
      act(vectors_.q.segment(q, m.n_q()), state.q.segment(m.q0, m.n_q()));
      act(vectors_.v.segment(v, m.n_v()), state.v.segment(m.v0, m.n_v()));
      q += m.n_q();
      v += m.n_v();
    }
  }
  const Group<double, Max>& group_;
  GroupVectors<double, Max>& vectors_;
};

/// For a part that deforms locally: adds to its velocities the rigid motion that restores its momentum P and
/// its angular momentum L. from, to: the evaluations of the part before and after the projection.
inline void keep_rigid_momenta(const PartModel& m, const PartWorkspace<double>& from,
                               const PartWorkspace<double>& to, State& state) {
  const LocalMotion before = detail::local_motion(m, from), now = detail::local_motion(m, to);
  const Vec3<double> P = from.R * before.momentum;
  Vec<double, 6> missing;
  missing << to.R.transpose() * P - now.momentum,
      to.R.transpose() * (from.R * before.angular_momentum + (from.c - to.c).cross(P)) - now.angular_momentum;
  const Eigen::Matrix<double, 6, 6> inertia = m.local->rigid_inertia(*to.local);
  const Vec<double, 6> scale = equalising_scales(inertia.diagonal());
  const Eigen::Matrix<double, 6, 6> scaled = scale.asDiagonal() * inertia * scale.asDiagonal();
  const Vec<double, 6> rigid = scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(missing)));
  state.v.segment<3>(m.v0) += to.R * rigid.head<3>();
  state.v.segment<3>(m.v0 + 3) += rigid.tail<3>();
}

/// Sets the velocities of parts whose coordinates the projection has changed, so that their generalised
/// momenta M v, and P and L, do not change. For a part that deforms locally, only P and L are restored; the
/// velocities of its nodes relative to its frame are kept. before, now: evaluations at the coordinates before
/// and after the projection.
template <int Max>
void keep_momenta(const Group<double, Max>& group, const Workspace<double>& before,
                  const Workspace<double>& now, State& state) {
  for (int i = 0; i < group.parts(); ++i) {
    const PartModel& m = group.model(i);
    const PartWorkspace<double>&from = before.parts[at(group.part(i))], &to = now.parts[at(group.part(i))];
    if (m.local != nullptr) {
      keep_rigid_momenta(m, from, to, state);
      continue;
    }
    VecMax<double> momentum = from.M() * from.v_r;
    const Vec3<double> P = from.R * momentum.head<3>();
    const Vec3<double> L = from.R * momentum.segment<3>(3) + (from.c - to.c).cross(P);
    momentum.head<3>() = to.R.transpose() * P;
    momentum.segment<3>(3) = to.R.transpose() * L;
    if (to.stiffening > 0) momentum.tail(m.n_s) += to.stiffening * (m.part->K_s() * from.v_r.tail(m.n_s));
    to.solve_mass(momentum);
    part_velocities(m, state.v) = world_velocity(to, momentum);
  }
}

inline std::vector<int> parts_of(const Group<double, kMaxVelocities>& group) {
  return {group.part(0)};
}
inline const std::vector<int>& parts_of(const Group<double, Eigen::Dynamic>& group) {
  return group.island()->parts;
}

/// Projects a group onto its joints and limits. closed: whether joints of the group have just become closed.
/// step.work: an evaluation of the group. scratch: scratch storage; its contents are ignored. If `impulses`
/// is given, the function adds to it the impulses that close joints, N s.
template <int Max>
void project_group(StepContext& step, const Group<double, Max>& group, bool closed,
                   Workspace<double>& scratch, VecX<double>* impulses = nullptr) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  GroupVectors<double, Max>& vectors = group_vectors(group, work);
  Snapshot<Max> before(group, state, vectors);
  Projection<Max> projection(step, group, vectors);
  if (impulses != nullptr) projection.add_impulses_to(*impulses);
  const bool pushed = projection.coordinates();
  // The impulses that close a joint do work. The correction of the error of a step has no entry in the
  // ledger: its change of energy is an error, which appears in the balance.
  double joints = 0, rows = 0;
  if (!pushed && !closed) {
    step.counters.limit_impulses += projection.velocities(joints, rows);
    state.work[static_cast<int>(Work::limits)] += rows;
    return;
  }
  const auto& parts = parts_of(group);
  before.swap(state);
  const double energy = dynamics.energy(step.t, state.q, state.v, parts, scratch);
  before.swap(state);
  if (group.island() != nullptr)
    dynamics.factor_joints(step.t, state.q, state.v, state.joints, *group.island(), work);
  else
    dynamics.evaluate_masses(step.t, state.q, state.v, parts, work);
  // scratch has the evaluation before the projection of the coordinates. This projection does not change
  // velocities, so keep_momenta() reads them from scratch.
  if (pushed) keep_momenta(group, scratch, work, state);
  projection.forget();
  step.counters.limit_impulses += projection.velocities(joints, rows);
  state.work[static_cast<int>(pushed ? Work::limits : Work::projection)] +=
      dynamics.energy(step.t, state.q, state.v, parts, scratch) - energy;
}

/// Returns whether a parameter has passed a limit, or moves at a limit.
inline bool passes_limit(const PartModel& m, State& state) {
  for (int k = 0; k < m.n_s; ++k)
    if ((limit_mode(state, m, k) != 0 && state.v[m.v0 + 6 + k] != 0) ||
        !m.limits[at(k)].contains(state.q[m.q0 + 7 + k]))
      return true;
  return false;
}

/// Sets the mode of open joints with a small gap and a small rate of the gap to closed. any_rate: whether the
/// rate may be large. A method of first order leaves a gap of h |bias| alpha / beta^2 on a rotating joint,
/// with bias = -gamma of Eq. (13) and the gains alpha and beta of Baumgarte's terms. For methods of first
/// order, the bound of a small gap is therefore larger by twice this gap, up to kMaxGap. The bound of a small
/// rate is increased by twice this gap times the rotation rate. Returns whether any joint closed.
inline bool close_joints(const Dynamics& dynamics, const Island& island, bool any_rate,
                         const Workspace<double>& work, State& state) {
  const Model& model = dynamics.model();
  const double rate = model.body().stabilization.rate;
  const Gains gains = work.joints.gains;
  const bool first_order = dynamics.joint_policy().first_order;
  bool any_closed = false;
  for (const int j : island.joints) {
    if (state.joints[at(j)] != JointMode::closing) continue;
    const JointModel& joint = model.joints()[at(j)];
    auto size = [&](const VecX<double>& rows) { return rows.segment(joint.row, joint.rows).norm(); };
    const double method_gap = first_order && gains.beta > 0 ? 2 * state.h * size(work.joints.bias) *
                                                                  gains.alpha / (gains.beta * gains.beta)
                                                            : 0;
    const double rotation_rate = std::sqrt(size(work.joints.bias) / joint.length);
    const bool near =
        size(work.joints.C) <= std::min(kClosedGap * joint.length + method_gap, kMaxGap * joint.length);
    const bool slow =
        any_rate || size(work.joints.C_dot) <= kClosedRate * joint.length * rate + rotation_rate * method_gap;
    if (!near || !slow) continue;
    state.joints[at(j)] = JointMode::closed;
    any_closed = true;
  }
  return any_closed;
}

/// A gap is regarded as closing if it shrinks faster than this share of beta times the gap, m/s.
inline constexpr double kClosingShare = 0.1;

/// Throws UnsatisfiableModel if a joint should have closed by now, its gap no longer shrinks, and rows of
/// other joints contradict its rows. step.work: the last evaluation of the step that ends at step.t.
/// patience: time after which a joint should have closed, in units of 1 / beta; if it is 0, the function also
/// throws for a gap that still shrinks.
inline void fail_on_unclosable_joint(StepContext& step, const Island& island, double patience = kPatience) {
  const Model& model = step.model();
  Workspace<double>& work = step.work;
  const double beta = work.joints.gains.beta;
  auto check_joint = [&](int j) {
    const JointMode mode = work.joints.modes[at(j)];
    if (mode != JointMode::closing && (mode != JointMode::closed || step.joint_policy().projected)) return;
    const JointModel& joint = model.joints()[at(j)];
    const double gap = work.joints.C.segment(joint.row, joint.rows).norm();
    if (!(gap > kStuckGap * joint.length) || !(beta * (step.t - std::max(0.0, joint.joint->on())) > patience))
      return;
    const double shrinking =
        -work.joints.C.segment(joint.row, joint.rows).dot(work.joints.C_dot.segment(joint.row, joint.rows)) /
        gap;
    if (patience > 0 && shrinking > kClosingShare * beta * gap) return;
    const double requested = wanted(model, work.joints, j).norm();
    auto disagrees = [&](int k) {
      return acts(work.joints.modes[at(k)]) && disagreement(model, work, k) > 0.5 * requested;
    };
    auto dependent = std::find_if(island.joints.begin(), island.joints.end(), disagrees);
    if (dependent == island.joints.end()) {
      if (!joint.joint->one_sided() || !disagrees(j)) return;
      dependent = std::find_if(island.strings.begin(), island.strings.end(),
                               [&](int k) { return k != j && disagrees(k); });
      if (dependent == island.strings.end())
        dependent = std::find(island.strings.begin(), island.strings.end(), j);
    }
    const bool closed = std::any_of(island.joints.begin(), island.joints.end(),
                                    [&](int k) { return work.joints.modes[at(k)] == JointMode::closed; });
    const Group<double, Eigen::Dynamic> group(model, work, island, closed);
    throw Projection<Eigen::Dynamic>(step, group, work.joints.vectors[group.number()])
        .contradiction(j, gap, *dependent);
  };
  std::for_each(island.joints.begin(), island.joints.end(), check_joint);
  std::for_each(island.strings.begin(), island.strings.end(), check_joint);
}

/// Sets the mode of closing strings, except of strings that are too long by more than a small gap. The mode
/// becomes slack if the distance of the ends is below the length of the string, otherwise closed.
inline void close_strings(const Model& model, const Island& island, const Workspace<double>& work,
                          State& state) {
  for (const int j : island.strings) {
    const JointModel& string = model.joints()[at(j)];
    if (state.joints[at(j)] == JointMode::closing && work.joints.C[string.row] > -kClosedGap * string.length)
      state.joints[at(j)] = work.joints.C[string.row] > 0 ? JointMode::slack : JointMode::closed;
  }
}

/// Sets the modes of strings: closed if the string is taut, otherwise slack. A string is taut if the distance
/// of its ends is at least its length, within kTaut, and the ends do not approach each other.
inline void update_string_modes(const Model& model, const Island& island, const Workspace<double>& work,
                                State& state) {
  const double rate = model.body().stabilization.rate;
  for (const int j : island.strings) {
    JointMode& mode = state.joints[at(j)];
    if (mode != JointMode::closed && mode != JointMode::slack) continue;
    const JointModel& string = model.joints()[at(j)];
    const bool taut = work.joints.C[string.row] <= kTaut * string.length &&
                      work.joints.C_dot[string.row] <= kTaut * string.length * rate;
    mode = taut ? JointMode::closed : JointMode::slack;
  }
}

/// Projects an island of rigid parts on ball joints. Returns false if the island needs the general
/// projection: if its last evaluation did not use RigidIsland, or RigidIsland::close() failed.
inline bool project_rigid_island(const Model& model, const Island& island, Workspace<double>& work,
                                 State& state) {
  RigidWorkspace* rigid = rigid_workspace(island, work);
  if (rigid == nullptr) return false;
  return model.rigid_islands()[at(island.rigid)].close(island, rounding(model),
                                                       work.joints.W_c[island_index(model, island)].blocks(),
                                                       *rigid, state.q, state.v);
}

/// Closes the joints and strings of an island with small gaps, and projects the island.
inline void project_island(StepContext& step, const Island& island, Workspace<double>& scratch) {
  const Model& model = step.model();
  State& state = step.state;
  Workspace<double>& work = step.work;
  auto evaluate = [&] {
    step.dynamics.evaluate_joints(step.t, state.q, state.v, state.joints, island, work);
  };
  auto closing = [&](int j) { return state.joints[at(j)] == JointMode::closing; };
  fail_on_unclosable_joint(step, island);
  bool closed = false;
  if (std::any_of(island.joints.begin(), island.joints.end(), closing) ||
      std::any_of(island.strings.begin(), island.strings.end(), closing)) {
    evaluate();
    closed = step.joint_policy().projected && close_joints(step.dynamics, island, false, work, state);
    close_strings(model, island, work, state);
    if (closed) step.dynamics.factor_joints(step.t, state.q, state.v, state.joints, island, work);
  }
  const Group<double, Eigen::Dynamic> group(model, work, island, true);
  project_group(step, group, closed, scratch);
  if (island.strings.empty()) return;
  evaluate();
  update_string_modes(model, island, work, state);
}

}  // namespace projection

PLIANT_INLINE void engage_joints(StepContext& step, const Island& island, Workspace<double>& scratch,
                                 VecX<double>& impulses) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  dynamics.factor_joints(step.t, state.q, state.v, state.joints, island, work);
  if (step.joint_policy().projected) projection::close_joints(dynamics, island, true, work, state);
  projection::close_strings(step.model(), island, work, state);
  dynamics.factor_joints(step.t, state.q, state.v, state.joints, island, work);
  const Group<double, Eigen::Dynamic> group(step.model(), work, island, true);
  projection::project_group(step, group, true, scratch, &impulses);
  dynamics.evaluate_joints(step.t, state.q, state.v, state.joints, island, work);
  projection::update_string_modes(step.model(), island, work, state);
}

PLIANT_INLINE void project_joints(StepContext& step) {
  const State& state = step.state;
  if (step.model().joints().empty() || !state.q.allFinite() || !state.v.allFinite()) return;
  Workspace<double> scratch;
  for (const Island& island : step.model().islands()) {
    if (sleeps(state, island.parts.front())) continue;
    if (projection::project_rigid_island(step.model(), island, step.work, step.state)) continue;
    projection::project_island(step, island, scratch);
  }
}

PLIANT_INLINE void project_limits(StepContext& step) {
  State& state = step.state;
  if (!all_finite(state.q) || !all_finite(state.v)) return;
  Workspace<double> scratch;
  projection::for_each_alone(step.model(), step.work, [&](const Group<double, kMaxVelocities>& group) {
    if (!projection::passes_limit(group.model(0), state)) return;
    step.dynamics.evaluate_masses(step.t, state.q, state.v, projection::parts_of(group), step.work);
    projection::project_group(step, group, false, scratch);
  });
}

PLIANT_INLINE void fail_on_open_conflict(StepContext& step) {
  for (const Island& island : step.model().islands())
    if (projection::rigid_workspace(island, step.work) == nullptr)
      projection::fail_on_unclosable_joint(step, island, 0);
}

}  // namespace pliant
