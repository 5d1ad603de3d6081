// The stages of the evaluation of all parts and joints, Eqs. (11)-(14), in the order in which
// Dynamics::evaluate() calls them. part_stages.h has the stages of one part.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/constraint/constraints.h>
#include <pliant/body/stages/evaluation.h>
#include <pliant/body/stages/loads.h>
#include <pliant/body/stages/part_stages.h>
#include <pliant/local/solid/inverted_element.h>

namespace pliant::detail {

// Before the stages: sizes, and which parts and islands each stage evaluates.

/// Marks the rigid islands that this evaluation uses. If only rates are requested, these are the awake rigid
/// islands whose joints are all closed and projected; otherwise there are none.
template <class S>
void choose_rigid_islands(const Evaluation<S>& e) {
  const auto& rigid_islands = e.model().rigid_islands();
  e.work.rigid.resize(rigid_islands.size());
  for (std::size_t k = 0; k < rigid_islands.size(); ++k) {
    const Island& island = e.model().islands()[static_cast<std::size_t>(rigid_islands[k].island())];
    const bool rates = e.rates_only && e.modes != nullptr;
    e.work.rigid[k].used = rates && e.dynamics.joint_policy().projected && !e.skips(island) &&
                           std::all_of(island.joints.begin(), island.joints.end(), [&](int j) {
                             return e.modes->joints[static_cast<std::size_t>(j)] == JointMode::closed;
                           });
  }
}

/// Lists the parts that are evaluated before any joint: parts without joints, and all parts of islands that
/// are not evaluated with their joints. If a rigid island is used and is RigidWorkspace::prepared, only its
/// parts with loads are listed. If only rates are requested, sleeping parts are left out, unless loads act on
/// them or on their island: the loads need their positions.
template <class S>
void list_parts_before_joints(const Evaluation<S>& e) {
  const Model& model = e.model();
  std::vector<int>& list = e.work.before_joints;
  const bool may_sleep = e.rates_only && e.modes != nullptr && !e.modes->at_rest.empty();
  if (may_sleep) {
    list.clear();
    for (const int i : model.lone_parts())
      if (!e.skips(i) || e.part(i).loaded) list.push_back(i);
  } else {
    list = model.lone_parts();
  }
  for (const Island& island : model.islands()) {
    if (!island.loaded && e.skips(island)) continue;
    const bool ready = e.uses_rigid(island) && e.work.rigid[static_cast<std::size_t>(island.rigid)].prepared;
    if (!ready && !e.with_joints(island)) list.insert(list.end(), island.parts.begin(), island.parts.end());
  }
  for (const int i : model.loaded_parts()) {
    const PartModel& m = e.part(i);
    if (e.uses_rigid(m) && e.work.rigid[static_cast<std::size_t>(m.rigid_island)].prepared) list.push_back(i);
  }
}

/// Resizes the workspace, and decides which parts and islands each stage evaluates.
template <class S>
void start_evaluation(const Evaluation<S>& e) {
  const std::size_t n_parts = e.model().parts().size();
  e.work.parts.resize(n_parts);
  e.work.without_inertia.resize(n_parts);
  e.work.v_dot.resize(e.model().n_v());
  e.work.power.setConstant(S(0.0));
  forget_coordinates(e);
  if (e.modes != nullptr) e.work.inputs = e.modes->inputs;
  if (e.fixed_modes != nullptr) e.work.inputs = e.fixed_modes->inputs;
  choose_rigid_islands<S>(e);
  list_parts_before_joints<S>(e);
}

// Stages 1 to 3 of the parts.

/// Stage 1 of a part that is evaluated with its rigid island: positions for its loads and, at the first
/// evaluation, the constant M.
inline void prepare_rigid_part(const Evaluation<double>& e, int i) {
  const PartModel& m = e.part(i);
  PartWorkspace<double>& w = e.part_work(i);
  const bool known = w.rigid == &m;
  evaluate_positions<double>(m, e.t, e.q, e.v, w);
  if (!known) {
    set_rigid_mass(m, w);
    factor_part_mass(e.model(), i, e.work);
  }
  w.f.setZero(6);
}

/// Runs stages 1 to 3 of part i, and stage 5 if the part is not loaded, one after the other while the part is
/// in the cache. A part without coordinates has stage 1 only. Throws InvertedElement, with the name of the
/// part, if an element of the part is inverted.
template <class S>
void evaluate_part(const Evaluation<S>& e, int i) {
  const PartModel& m = e.part(i);
  PartWorkspace<S>& w = e.part_work(i);
  if constexpr (std::is_same_v<S, double>)
    if (e.uses_rigid(m)) return prepare_rigid_part(e, i);
  evaluate_positions<S>(m, e.t, e.q, e.v, w);  // 1 positions
  w.power.setConstant(S(0.0));
  if (m.q0 < 0) return;
  evaluate_mass<S>(m, w);  // 2 mass: M, g_q
  with_name_of_part(m.part->name(), [&] {
    evaluate_own_forces<S>(m, e.gravity, e.t, w, e.dynamics.pool());  // 3 forces without loads
  });
  if (const auto& changing = e.model().body().changing_gravity) add_gravity_power<S>(m, *changing, e.t, w);
  if (!m.loaded) accelerate_freely<S>(e, i);  // 5 accelerations without joints
}

/// Stages 1 to 3 of the parts that are evaluated before any joint.
template <class S>
void evaluate_parts(const Evaluation<S>& e) {
  const std::vector<int>& list = e.work.before_joints;
  e.for_each(list.size(), [&](int k) { evaluate_part<S>(e, list[static_cast<std::size_t>(k)]); });
  for (RigidWorkspace& rigid : e.work.rigid) rigid.prepared = rigid.prepared || rigid.used;
}

/// Stage 3 for loads: f_q = L^T f of all loads (stages/loads.h). Then stage 5 of the loaded parts: loads act
/// on these parts or read their state.
template <class S>
void evaluate_loads(const Evaluation<S>& e) {
  const std::vector<int>& loaded = e.model().loaded_parts();
  if (loaded.empty()) return;
  apply_loads<S>(e);
  e.for_each(loaded.size(), [&](int k) {
    const int i = loaded[static_cast<std::size_t>(k)];
    const PartModel& m = e.part(i);
    if (m.q0 < 0) return;
    add_port_forces<S>(m, e.part_work(i));
    if (!e.uses_rigid(m)) accelerate_freely<S>(e, i);
  });
}

// Stage 4: joints.

/// Resizes the workspace of the joints.
template <class S>
void size_joint_workspace(const Model& model, Workspace<S>& work) {
  ConstraintWorkspace<S>& joints = work.joints;
  work.parts.resize(model.parts().size());
  joints.modes.resize(model.joints().size(), JointMode::off);
  for (VecX<S>* rows : {&joints.C, &joints.C_dot, &joints.bias, &joints.lambda})
    if (rows->size() != model.n_rows()) rows->setConstant(model.n_rows(), S(0.0));
  joints.Cq.resize(model.n_side_values());
  joints.Y.resize(model.n_side_values());
  joints.W_c.resize(model.islands().size());
  joints.W_closed.resize(model.islands().size());
  joints.pushed.resize(model.islands().size());
  joints.vectors.resize(model.islands().size());
}

/// Sets modes and Baumgarte's gains of the joints from the state. Joints of skipped islands get the mode off.
template <class S>
void set_joint_modes(const Evaluation<S>& e) {
  ConstraintWorkspace<S>& joints = e.work.joints;
  const Stabilization& rule = e.model().body().stabilization;
  joints.modes = e.modes->joints;
  for (const Island& island : e.model().islands()) {
    if (!e.skips(island)) continue;
    for (const std::vector<int>* list : {&island.joints, &island.strings})
      for (const int j : *list) joints.modes[static_cast<std::size_t>(j)] = JointMode::off;
  }
  joints.gains = rule.gains(e.modes->h, e.dynamics.joint_policy().step_consistent);
  joints.max_speed = rule.speed * rule.rate;
}

/// Copies modes, gains and pushed one-sided rows of the evaluation whose derivative is computed.
template <class S>
void copy_joint_modes(const Evaluation<S>& e) {
  ConstraintWorkspace<S>& joints = e.work.joints;
  const ConstraintWorkspace<double>& fixed = e.fixed_modes->joints;
  joints.modes = fixed.modes;
  joints.gains = fixed.gains;
  joints.max_speed = fixed.max_speed;
  joints.pushed = fixed.pushed;
  if constexpr (!std::is_same_v<S, double>)
    for (std::size_t i = 0; i < e.model().islands().size(); ++i) {
      joints.W_c[i].refer_to(fixed.W_c[i]);
      joints.W_closed[i].refer_to(fixed.W_closed[i]);
    }
}

/// Sets up the workspace of the joints: sizes, lambda = 0, modes and gains.
template <class S>
void start_joints(const Evaluation<S>& e) {
  ConstraintWorkspace<S>& joints = e.work.joints;
  size_joint_workspace<S>(e.model(), e.work);
  joints.lambda.setConstant(S(0.0));
  if (e.modes != nullptr)
    set_joint_modes<S>(e);
  else if (e.fixed_modes != nullptr)
    copy_joint_modes<S>(e);
  else
    joints.modes.assign(e.model().joints().size(), JointMode::off);
  joints.stabilise_closed = !e.dynamics.joint_policy().projected;
}

/// Returns the rows of the parameters of an island that are at a limit and do not move.
inline std::vector<OneSidedRow> limits_at_rest(const Evaluation<double>& e, const Island& island) {
  std::vector<OneSidedRow> limits;
  for (std::size_t k = 0; k < island.parts.size() && e.modes != nullptr; ++k) {
    const PartModel& m = e.part(island.parts[k]);
    for_each_limit_at_rest(m, e.modes->at_limit.data() + m.limit0, e.part_work(island.parts[k]),
                           static_cast<int>(k), [&](const OneSidedRow& row) { limits.push_back(row); });
  }
  return limits;
}

/// Stage 4 of an island: C, C_dot, bias and C_q, then M^-1 C_q^T and W_c, then lambda and the accelerations
/// of its parts. evaluate(i): evaluates part i; used if the parts are evaluated together with their joints.
template <class S>
void evaluate_island(const Evaluation<S>& e, const Island& island, const EvaluatePart& evaluate) {
  if (e.uses_rigid(island) || e.skips(island)) return;
  evaluate_and_factor_joints<S>(e.model(), island, e.t, e.work.parts, e.work.joints,
                                e.with_joints(island) ? evaluate : EvaluatePart());
  if constexpr (std::is_same_v<S, double>)
    solve_joints(e.model(), island, limits_at_rest(e, island), e.work);
  else
    solve_joints(e.model(), island, e.work);
}

/// Stage 4: joints, Eqs. (12)-(14), island by island.
template <class S>
void evaluate_islands(const Evaluation<S>& e) {
  const Model& model = e.model();
  if (model.joints().empty()) return;
  start_joints<S>(e);
  auto place = [&](int i) { evaluate_part<S>(e, i); };
  e.for_each(model.islands().size(), [&](int k) {
    evaluate_island<S>(e, model.islands()[static_cast<std::size_t>(k)], std::ref(place));
  });
  e.work.power += joint_power<S>(model, e.work);
}

/// All stages of the islands of rigid parts on ball joints, see constraint/rigid_island.h.
template <class S>
void evaluate_rigid_islands(const Evaluation<S>& e) {
  if constexpr (std::is_same_v<S, double>)
    for (std::size_t k = 0; k < e.work.rigid.size(); ++k) {
      if (!e.work.rigid[k].used) continue;
      const RigidIsland& island = e.model().rigid_islands()[k];
      island.accelerate(e.model(), e.q, e.v, e.gravity, e.work, e.work.rigid[k]);
      if (const auto& changing = e.model().body().changing_gravity)
        e.work.power[static_cast<int>(Work::actuation)] +=
            gravity_power<double>(*changing, e.t, island.mass_moment(e.q, e.work.rigid[k]));
    }
}

// Stage 5: accelerations.

/// Stage 5 of part i: sets its entries of v_dot, and adds its powers to work.power. A sleeping part has zero
/// acceleration and no power.
template <class S>
void collect_part(const Evaluation<S>& e, int i) {
  const PartModel& m = e.part(i);
  VecX<S>& v_dot = e.work.v_dot;
  if (m.q0 < 0) return;
  if (e.modes != nullptr && sleeps(*e.modes, i)) {
    v_dot.segment(m.v0, m.n_v()).setConstant(S(0.0));
    return;
  }
  const PartWorkspace<S>& w = e.part_work(i);
  e.work.power += w.power;
  v_dot.template segment<3>(m.v0) = w.R * w.a_r.template head<3>();
  v_dot.segment(m.v0 + 3, 3 + m.n_s) = w.a_r.segment(3, 3 + m.n_s);
  if constexpr (std::is_same_v<S, double>)
    // Joints and limits accelerate the local coordinates too. Without joints and limits, A_inverse is not
    // computed, and a_r differs from a_free only if an entry is not a number.
    if (m.local != nullptr && w.local->A_inverse.cols() == w.a_r.size() && w.a_r != w.local->a_free)
      m.local->push_all(m.joint_points, w.local->A_inverse * (w.a_r - w.local->a_free), *w.local,
                        v_dot.segment(m.v0 + 6 + m.n_s, m.n_d()));
}

/// Stage 5: v_dot of all parts that no rigid island has accelerated, and the sum of their powers.
template <class S>
void collect_accelerations(const Evaluation<S>& e) {
  for (const int i : e.model().lone_parts()) collect_part<S>(e, i);
  for (const Island& island : e.model().islands())
    if (!e.uses_rigid(island))
      for (const int i : island.parts) collect_part<S>(e, i);
}

}  // namespace pliant::detail
