// Before the coordinates move by h v: impulses that meet limits, strings and joints at the end of the step.
#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/project/project.h>

#include "projection.h"

namespace pliant {

using namespace projection;

namespace {

/// An iteration that leaves more than this part of the gaps has come to the rounding of the rows.
constexpr double kIdle = 0.9;
/// Most turn of a part in a step while a joint closes, rad.
constexpr double kMostTurnClosing = 0.2;

/// Adds to the velocities x of an island what takes the gaps at the end of the step, in `ahead`, off its
/// closed joints. False when they are closed there, or as near as rounding lets them come. widest: that of
/// the iteration before, and then of this one.
template <int Max>
bool close_ahead(const Model& model, const Island& island, const Group<double, Max>& group,
                 const State& state, const Workspace<double>& ahead, double h, VecX<double>& error,
                 VecMax<double, Max>& x, double& widest) {
  error.setZero(island.rows);
  const double before = std::exchange(widest, 0);
  for (const int j : island.joints) {
    const JointModel& joint = model.joints()[at(j)];
    if (state.joints[at(j)] != JointMode::closed) continue;
    const auto C = ahead.joints.C.segment(joint.row, joint.rows);
    widest = wider(C.norm() / rounding(joint, ahead), widest);
    error.segment(joint.island_row, joint.rows) = C / h;
  }
  if (!(widest > 1) || widest > kIdle * before) return false;
  group.correct(error, x);
  return true;
}

/// The same of an island whose last evaluation was a rigid island's, as often as it takes. An island that it
/// does not close is evaluated the general way.
bool close_ahead_on_rigid_island(const Dynamics& dynamics, const Island& island, Workspace<double>& work,
                                 State& state, double h, VecX<double>& q_end) {
  RigidWorkspace* rigid = rigid_workspace(island, work);
  if (rigid == nullptr) return false;
  const Model& model = dynamics.model();
  auto move_on = [&]() -> const VecX<double>& {
    for (const int i : island.parts) {
      const PartModel& m = model.parts()[at(i)];
      q_end.segment<7>(m.q0) = state.q.segment<7>(m.q0);
      advance_part(m, q_end, state.v.segment<6>(m.v0), h);
    }
    return q_end;
  };
  if (model.rigid_islands()[at(island.rigid)].close_ahead(
          rounding(model), h, work.joints.W_c[number_of(model, island)].blocks(), *rigid, state.v, move_on))
    return true;
  dynamics.factor_joints(state.time(), state.q, state.v, state.joints, island, work);
  return false;
}

bool any_closing(const Island& island, const Workspace<double>& work) {
  return std::any_of(island.joints.begin(), island.joints.end(),
                     [&](int j) { return work.joints.modes[at(j)] == JointMode::closing; });
}

/// In a step of h no part of an island that closes comes to turn by more than kMostTurnClosing: what a gap
/// pulls may swing about it for long, and gains energy by each step. The centres of mass go on as they were.
/// before: velocities at the start of the step. Returns the work of it.
template <int Max>
double cap_turns(const Group<double, Max>& group, const VecX<double>& before, double h,
                 VecMax<double, Max>& x, VecMax<double, Max>& capped) {
  capped = x;
  for (int i = 0; i < group.parts(); ++i) {
    auto v_r = group.share(capped, i);
    const double turn = h * v_r.template segment<3>(3).norm(),
                 most = std::max(kMostTurnClosing, h * before.segment<3>(group.model(i).v0 + 3).norm());
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

/// Whether a parameter passes a limit when it moves on for a time h.
template <int Max>
bool crosses(const Group<double, Max>& group, double h, const State& state) {
  for (int i = 0; i < group.parts(); ++i) {
    const PartModel& m = group.model(i);
    for (int k = 0; k < m.n_s; ++k)
      if (!m.limits[at(k)].contains(state.q[m.q0 + 7 + k] + h * state.v[m.v0 + 6 + k])) return true;
  }
  return false;
}

/// Which limits the parameters of a group are at when they have moved on.
template <int Max>
void note_limits(const Group<double, Max>& group, double h, State& state) {
  for (int i = 0; i < group.parts(); ++i) {
    const PartModel& m = group.model(i);
    for (int k = 0; k < m.n_s; ++k) {
      const double q = state.q[m.q0 + 7 + k], then = q + h * state.v[m.v0 + 6 + k];
      const Range range = m.limits[at(k)];
      limit_mode(state, m, k) = then <= range.min ? -1 : (then >= range.max ? 1 : 0);
      // A rate too small to leave the limit is rounding of the impulses of others: it rests.
      if (limit_mode(state, m, k) != 0 && then == q) state.v[m.v0 + 6 + k] = 0;
    }
  }
}

}  // namespace

void pre_step_impulses(const Dynamics& dynamics, Workspace<double>& work, const VecX<double>& before,
                       State& state, double h, VecX<double>& q_end, Workspace<double>& ahead,
                       StepCounters& counters) {
  const Model& model = dynamics.model();
  if (!model.islands().empty()) q_end.resize(state.q.size());
  auto act = [&](const auto& group) {
    constexpr int kMax = std::decay_t<decltype(group)>::kMax;
    const Island* island = group.island();
    if (island != nullptr && sleeps(state, island->parts.front())) return;
    if (island == nullptr && !crosses(group, h, state)) return note_limits(group, h, state);
    if (island != nullptr && close_ahead_on_rigid_island(dynamics, *island, work, state, h, q_end)) return;
    GroupVectors<double, kMax>& kept = kept_vectors(group, work);
    auto &x = kept.x, &now = kept.before, &joined = kept.joined;
    gather_velocities(group, state.v, x);
    if (island != nullptr && any_closing(*island, work)) {
      state.work[static_cast<int>(Work::baumgarte)] += cap_turns(group, before, h, x, now);
      for (int i = 0; i < group.parts(); ++i)
        scatter_velocity(group.model(i), group.workspace(i), group.share(x, i), state.v);
    }
    // The velocity that just reaches a limit, or the length of a string, at the end of the step.
    now = x;
    auto bound = [&](const OneSidedRow& row) {
      if (row.part < 0) {
        const int j = island->strings[at(row.k)];
        const JointMode mode = state.joints[at(j)];
        const double C = ahead.joints.C[model.joints()[at(j)].row];
        if (mode == JointMode::off || mode == JointMode::closing || row.sign < 0 ||
            C > -rounding(model.joints()[at(j)], ahead))
          return -std::numeric_limits<double>::infinity();
        return group.value(row, now) - C / h;
      }
      const Range range = group.model(row.part).limits[at(row.k)];
      const double q = state.q[group.model(row.part).q0 + 7 + row.k];
      return row.sign * ((row.sign > 0 ? range.min : range.max) - q) / h;
    };
    std::vector<std::pair<std::int8_t*, std::int8_t>> stopped;
    double widest = std::numeric_limits<double>::infinity();
    for (int iteration = 0; iteration < kMostIterations; ++iteration) {
      // Impulses at the start of the step that close the joints at its end: h v is projected, not q alone,
      // which keeps the energy of turning parts (the method SHAKE; Ryckaert, Ciccotti & Berendsen 1977).
      bool open = false;
      if (island != nullptr) {
        for (int i = 0; i < group.parts(); ++i) {
          const PartModel& m = group.model(i);
          q_end.segment(m.q0, m.n_q()) = state.q.segment(m.q0, m.n_q());
          advance_whole_part(m, q_end, state.v, h);
        }
        dynamics.evaluate_joints(state.time() + h, q_end, state.v, state.joints, *island, ahead);
        now = x;
        open = dynamics.joint_policy().projected &&
               close_ahead(model, *island, group, state, ahead, h, kept.rows, x, widest);
      }
      OneSidedRows<kMax> rows(group);
      joined = x;
      rows.meet_all(x, bound);
      if (!rows.empty()) state.work[static_cast<int>(Work::limits)] += kinetic_change(group, joined, x);
      if (!open && rows.empty()) break;
      for (int i = 0; i < group.parts(); ++i)
        scatter_velocity(group.model(i), group.workspace(i), group.share(x, i), state.v);
      if (!rows.empty())
        counters.limit_impulses += rows.for_each_pushed([&](const OneSidedRow& row, double) {
          if (row.part >= 0)
            stopped.emplace_back(&limit_mode(state, group.model(row.part), row.k), row.sign > 0 ? -1 : 1);
        });
      if (island == nullptr) break;
    }
    note_limits(group, h, state);
    for (const auto& [mode, side] : stopped) *mode = side;
  };
  for_each_alone(model, work, act);
  for_each_island(model, work, act);
}

void clamp_to_limits(const Model& model, State& state) {
  for (const PartModel& m : model.parts())
    for (int k = 0; k < m.n_s; ++k) {
      const std::int8_t mode = limit_mode(state, m, k);
      if (mode != 0) state.q[m.q0 + 7 + k] = mode < 0 ? m.limits[at(k)].min : m.limits[at(k)].max;
    }
}

}  // namespace pliant
