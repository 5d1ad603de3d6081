#include <pliant/body/dynamics.h>

#include <algorithm>
#include <functional>

#include <pliant/local/solid/inverted_element.h>

#include "loads.h"
#include "part_stages.h"

namespace pliant {

namespace {

/// Of a part that is evaluated with its rigid island: what its loads need, and what is constant.
void prepare_loads(const Model& model, int i, double t, const VecX<double>& q, const VecX<double>& v,
                   Workspace<double>& work) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(i)];
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(i)];
  const bool known = w.rigid == &m;
  positions<double>(m, t, q, v, w);
  if (!known) {
    masses<double>(m, w);
    take_factor(model, i, work);
  }
  w.f.setZero(6);
}

/// Whether the parts of an island sleep, which they do together.
bool asleep(const Island& island, const State* modes) {
  return modes != nullptr && sleeps(*modes, island.parts.front());
}

/// Whether an evaluation leaves an island to rigid_island.h.
template <class S>
bool is_rigid(const Island& island, const Workspace<S>& work) {
  return island.rigid >= 0 && work.rigid[static_cast<std::size_t>(island.rigid)].used;
}

}  // namespace

template <class S>
void Dynamics::choose_rigid_islands(const State* modes, Workspace<S>& work) const {
  const auto& islands = model_->rigid_islands();
  work.rigid.resize(islands.size());
  for (std::size_t k = 0; k < islands.size(); ++k) {
    const Island& island = model_->islands()[static_cast<std::size_t>(islands[k].island())];
    work.rigid[k].used = modes != nullptr && joint_policy_.projected && !asleep(island, modes) &&
                         std::all_of(island.joints.begin(), island.joints.end(), [&](int j) {
                           return modes->joints[static_cast<std::size_t>(j)] == JointMode::closed;
                         });
  }
  const bool any_sleep = modes != nullptr && !modes->at_rest.empty();
  if (any_sleep) {
    // Loads have to know where the parts are that they act on.
    work.one_by_one.clear();
    for (const int i : model_->lone_parts())
      if (!sleeps(*modes, i) || model_->parts()[static_cast<std::size_t>(i)].loaded)
        work.one_by_one.push_back(i);
  } else {
    work.one_by_one = model_->lone_parts();
  }
  for (const Island& island : model_->islands()) {
    if (!island.loaded && asleep(island, modes)) continue;
    const bool left_to_rigid =
        is_rigid(island, work) && work.rigid[static_cast<std::size_t>(island.rigid)].prepared;
    if (!left_to_rigid && !with_joints(island, work))
      work.one_by_one.insert(work.one_by_one.end(), island.parts.begin(), island.parts.end());
  }
  for (const int i : model_->loaded_parts()) {
    const int k = model_->parts()[static_cast<std::size_t>(i)].rigid_island;
    if (k < 0) continue;
    const RigidWorkspace& rigid = work.rigid[static_cast<std::size_t>(k)];
    if (rigid.used && rigid.prepared) work.one_by_one.push_back(i);
  }
}

template <class S>
bool Dynamics::with_joints(const Island& island, const Workspace<S>& work) const {
  return pool_ == nullptr && !island.loaded && !is_rigid(island, work);
}

template <class S>
void Dynamics::evaluate(double t, const VecX<S>& q, const VecX<S>& v, const State* modes,
                        const Workspace<double>* fixed_modes, bool rates_only, Workspace<S>& work) const {
  const Model& model = *model_;
  const auto& parts = model.parts();
  work.parts.resize(parts.size());
  work.held.resize(parts.size());
  work.v_dot.resize(model.n_v());
  work.power.setConstant(S(0.0));
  auto each = [&](std::size_t n, auto&& task) {
    if (pool_ != nullptr)
      pool_->run(static_cast<int>(n), std::ref(task));
    else
      for (std::size_t i = 0; i < n; ++i) task(static_cast<int>(i));
  };

  // What sleeps has no accelerations, and a stage leaves it out.
  const State* sleepers = rates_only ? modes : nullptr;
  choose_rigid_islands(sleepers, work);
  // Whether a part is evaluated with its rigid island, and none but its loads here.
  auto by_rigid_island = [&](const PartModel& m) {
    return m.rigid_island >= 0 && work.rigid[static_cast<std::size_t>(m.rigid_island)].used;
  };
  const Vec3<double> gravity = model.body().gravity_at(t);
  // A part that no load acts on is done in one go, while the caches hold it.
  auto evaluate_part = [&](int i) {
    const PartModel& m = parts[static_cast<std::size_t>(i)];
    PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(i)];
    if constexpr (std::is_same_v<S, double>)
      if (by_rigid_island(m)) return prepare_loads(model, i, t, q, v, work);
    positions<S>(m, t, q, v, w);
    w.power.setConstant(S(0.0));
    if (m.q0 < 0) return;
    masses<S>(m, w);
    try {
      own_forces<S>(m, gravity, t, w, pool_);
      if (model.body().changing_gravity) change_gravity<S>(m, *model.body().changing_gravity, t, w);
    } catch (const InvertedElement& failure) {
      throw InvertedElement("part '" + m.part->name() + "': " + failure.what());
    }
    if (!m.loaded) accelerate<S>(model, i, modes, fixed_modes, work);
  };
  each(work.one_by_one.size(), [&](int k) { evaluate_part(work.one_by_one[static_cast<std::size_t>(k)]); });
  for (RigidWorkspace& rigid : work.rigid) rigid.prepared = rigid.prepared || rigid.used;
  if (!model.loaded_parts().empty()) {
    apply_loads<S>(model, t, work);
    each(model.loaded_parts().size(), [&](int k) {
      const int i = model.loaded_parts()[static_cast<std::size_t>(k)];
      const PartModel& m = parts[static_cast<std::size_t>(i)];
      if (m.q0 < 0) return;
      gather_port_forces<S>(m, work.parts[static_cast<std::size_t>(i)]);
      if (!by_rigid_island(m)) accelerate<S>(model, i, modes, fixed_modes, work);
    });
  }
  if (!model.joints().empty()) join<S>(t, modes, sleepers, fixed_modes, std::ref(evaluate_part), work);
  if constexpr (std::is_same_v<S, double>)
    for (std::size_t k = 0; k < work.rigid.size(); ++k)
      if (work.rigid[k].used)
        model.rigid_islands()[k].accelerate(model, q, v, gravity, work.joints.rank, work, work.rigid[k]);
  auto finish = [&](int i) {
    const PartModel& m = parts[static_cast<std::size_t>(i)];
    if (m.q0 < 0) return;
    if (modes != nullptr && sleeps(*modes, i)) {
      work.v_dot.segment(m.v0, m.n_v()).setConstant(S(0.0));
      return;
    }
    const PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(i)];
    work.power += w.power;
    work.v_dot.template segment<3>(m.v0) = w.R * w.a_r.template head<3>();
    work.v_dot.segment(m.v0 + 3, 3 + m.n_s) = w.a_r.segment(3, 3 + m.n_s);
    if constexpr (std::is_same_v<S, double>)
      // What joints and limits push.
      if (m.local != nullptr && w.a_r != w.local->a_free)
        m.local->push_all(m.shared, w.local->A_inverse * (w.a_r - w.local->a_free), *w.local,
                          work.v_dot.segment(m.v0 + 6 + m.n_s, m.n_d()));
  };
  for (const int i : model.lone_parts()) finish(i);
  for (const Island& island : model.islands())
    if (!is_rigid(island, work))
      for (const int i : island.parts) finish(i);
}

template <class S>
void Dynamics::size_joints(Workspace<S>& work) const {
  const Model& model = *model_;
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

// joints: rows, W_c and its factor, forces; each island on its own
template <class S>
void Dynamics::join(double t, const State* modes, const State* sleepers, const Workspace<double>* fixed_modes,
                    const PlacePart& evaluate_part, Workspace<S>& work) const {
  const Model& model = *model_;
  ConstraintWorkspace<S>& joints = work.joints;
  size_joints(work);
  joints.lambda.setConstant(S(0.0));
  if (modes != nullptr) {
    const Stabilization& rule = model.body().stabilization;
    joints.modes = modes->joints;
    for (const Island& island : model.islands()) {
      if (!asleep(island, sleepers)) continue;
      for (const std::vector<int>* of : {&island.joints, &island.strings})
        for (const int j : *of) joints.modes[static_cast<std::size_t>(j)] = JointMode::off;
    }
    joints.gains = rule.gains(modes->h, joint_policy_.step_consistent);
    joints.most_speed = rule.speed * rule.rate;
  } else if (fixed_modes != nullptr) {
    joints.modes = fixed_modes->joints.modes;
    joints.gains = fixed_modes->joints.gains;
    joints.most_speed = fixed_modes->joints.most_speed;
    joints.pushed = fixed_modes->joints.pushed;
    if constexpr (!std::is_same_v<S, double>)
      for (std::size_t i = 0; i < model.islands().size(); ++i) {
        joints.W_c[i].refer_to(fixed_modes->joints.W_c[i]);
        joints.W_closed[i].refer_to(fixed_modes->joints.W_closed[i]);
      }
  } else {
    joints.modes.assign(model.joints().size(), JointMode::off);
  }
  joints.stabilise_closed = !joint_policy_.projected;
  auto solve = [&](int i) {
    const Island& island = model.islands()[static_cast<std::size_t>(i)];
    if (is_rigid(island, work) || asleep(island, sleepers)) return;
    evaluate_and_factor_joints<S>(model, island, t, work.parts, joints,
                                  with_joints(island, work) ? evaluate_part : PlacePart());
    if constexpr (std::is_same_v<S, double>) {
      std::vector<OneSidedRow> limits;
      for (std::size_t k = 0; k < island.parts.size() && modes != nullptr; ++k) {
        const auto p = static_cast<std::size_t>(island.parts[k]);
        for_each_rest(model.parts()[p], modes->at_limit.data() + model.parts()[p].limit0, work.parts[p],
                      static_cast<int>(k), [&](const OneSidedRow& row) { limits.push_back(row); });
      }
      solve_joints(model, island, std::move(limits), work);
    } else {
      solve_joints(model, island, work);
    }
  };
  const int n = static_cast<int>(model.islands().size());
  if (pool_ != nullptr)
    pool_->run(n, std::ref(solve));
  else
    for (int i = 0; i < n; ++i) solve(i);
  work.power += joint_power<S>(model, work);
}

void Dynamics::place_anchors(double t, const VecX<double>& q, const VecX<double>& v,
                             const std::vector<JointMode>& modes, const Island& island,
                             Workspace<double>& work) const {
  size_joints(work);
  for (const std::vector<int>* joints : {&island.joints, &island.strings})
    for (const int j : *joints)
      work.joints.modes[static_cast<std::size_t>(j)] = modes[static_cast<std::size_t>(j)];
  for (const int i : island.anchors) {
    const PartModel& m = model_->parts()[static_cast<std::size_t>(i)];
    PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(i)];
    if (m.motion != nullptr || w.port_x.empty()) positions<double>(m, t, q, v, w);
  }
}

void Dynamics::evaluate_joints(double t, const VecX<double>& q, const VecX<double>& v,
                               const std::vector<JointMode>& modes, const Island& island,
                               Workspace<double>& work) const {
  place_anchors(t, q, v, modes, island, work);
  auto place = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    positions<double>(model_->parts()[k], t, q, v, work.parts[k]);
  };
  pliant::evaluate_joints<double>(*model_, island, t, work.parts, work.joints, std::ref(place));
}

void Dynamics::factor_joints(double t, const VecX<double>& q, const VecX<double>& v,
                             const std::vector<JointMode>& modes, const Island& island,
                             Workspace<double>& work, RankRule rank) const {
  work.joints.rank = rank;
  place_anchors(t, q, v, modes, island, work);
  work.held.resize(work.parts.size());
  auto place = [&](int i) {
    const auto k = static_cast<std::size_t>(i);
    positions<double>(model_->parts()[k], t, q, v, work.parts[k]);
    masses<double>(model_->parts()[k], work.parts[k]);
    take_factor(*model_, i, work);
  };
  evaluate_and_factor_joints<double>(*model_, island, t, work.parts, work.joints, std::ref(place));
}

void Dynamics::accelerations(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                             Workspace<double>& work, RankRule rank) const {
  work.joints.rank = rank;
  evaluate<double>(t, q, v, &modes, nullptr, false, work);
}

void Dynamics::rates(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                     Workspace<double>& work, RankRule rank) const {
  work.joints.rank = rank;
  evaluate<double>(t, q, v, &modes, nullptr, true, work);
}

void Dynamics::evaluate_frame(const VecX<double>& q, const VecX<double>& v, int part,
                              Workspace<double>& work) const {
  work.parts.resize(model_->parts().size());
  work.held.resize(model_->parts().size());
  const PartModel& m = model_->parts()[static_cast<std::size_t>(part)];
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(part)];
  positions<double>(m, 0, q, v, w);  // of a part that has coordinates, which tell them at any time
  masses<double>(m, w);
}

void Dynamics::evaluate_masses(const VecX<double>& q, const VecX<double>& v, const std::vector<int>& parts,
                               Workspace<double>& work) const {
  for (const int i : parts) {
    evaluate_frame(q, v, i, work);
    take_factor(*model_, i, work);
  }
}

double Dynamics::energy(double t, const VecX<double>& q, const VecX<double>& v, const std::vector<int>& parts,
                        Workspace<double>& work) const {
  evaluate_masses(q, v, parts, work);
  Ledger ledger;
  for (const int i : parts)
    add_energy(t, model_->parts()[static_cast<std::size_t>(i)], work.parts[static_cast<std::size_t>(i)],
               ledger);
  auto ours = [&](const PortRef& ref) {
    return std::find(parts.begin(), parts.end(), ref.part) != parts.end();
  };
  for (const SpringModel& spring : model_->springs()) {
    if (!ours(spring.a) && !ours(spring.b)) continue;
    for (const PortRef& ref : {spring.a, spring.b})
      if (ref.part >= 0 && !ours(ref))
        positions<double>(model_->parts()[static_cast<std::size_t>(ref.part)], t, q, v,
                          work.parts[static_cast<std::size_t>(ref.part)]);
    add_energy(t, spring, work, ledger);
  }
  return ledger.energy();
}

template void Dynamics::evaluate(double, const VecX<Dual<1>>&, const VecX<Dual<1>>&, const State*,
                                 const Workspace<double>*, bool, Workspace<Dual<1>>&) const;

}  // namespace pliant
