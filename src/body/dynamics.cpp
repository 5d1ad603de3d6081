#include <pliant/body/dynamics.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include <pliant/body/one_sided_rows.h>
#include <pliant/local/inverted_element.h>
#include <pliant/math/rotation.h>

#include "loads.h"

namespace pliant {

namespace {

/// Adds the local deformation at the ports to their positions and velocities.
void displace_ports(const PartModel& m, PartWorkspace<double>& w) {
  VecX<double> of_d, of_d_dot;
  const auto d = m.local->at_nodes(w.local->d.data(), of_d),
             d_dot = m.local->at_nodes(w.local->d_dot.data(), of_d_dot);
  for (std::size_t k = 0; k < m.ports.size(); ++k) {
    const NodeWeights& at = m.node_weights[k];
    for (std::size_t i = 0; i < at.node.size(); ++i) {
      w.ports[k].p += at.weight[i] * d.row(at.node[i]).transpose();
      w.ports[k].p1 += at.weight[i] * d_dot.row(at.node[i]).transpose();
    }
  }
}

// positions: frames, parameters and attachment points in the world, Eqs. (1) and (9)
template <class S>
void positions(const PartModel& m, double t, const VecX<S>& q, const VecX<S>& v, PartWorkspace<S>& w) {
  const Part& part = *m.part;
  const auto n_ports = m.ports.size();
  std::optional<MovingFrame> prescribed;
  if (m.q0 < 0) {
    if (m.motion != nullptr) prescribed = m.motion->at(t);
    w.c = (prescribed ? prescribed->c : part.c0()).template cast<S>();
    w.R = (prescribed ? prescribed->R : m.R0).template cast<S>();
    w.q_s.resize(0);
    w.q_s_dot.resize(0);
    w.v_r.resize(0);
  } else {
    w.c = q.template segment<3>(m.q0);
    w.R = rotation<S>(q[m.q0 + 3], q[m.q0 + 4], q[m.q0 + 5], q[m.q0 + 6]);
    w.q_s = q.segment(m.q0 + 7, m.n_s);
    w.q_s_dot = v.segment(m.v0 + 6, m.n_s);
    w.v_r.resize(6 + m.n_s);
    w.v_r.template head<3>() = w.R.transpose() * v.template segment<3>(m.v0);
    w.v_r.tail(3 + m.n_s) = v.segment(m.v0 + 3, 3 + m.n_s);
  }
  if constexpr (std::is_same_v<S, double>)
    if (m.local != nullptr) {
      if (!w.local) w.local = m.local->workspace();
      w.local->d = q.segment(m.q0 + 7 + m.n_s, m.n_d());
      w.local->d_dot = v.segment(m.v0 + 6 + m.n_s, m.n_d());
      m.local->positions(part, w.q_s, w.v_r, *w.local, w.counters);
    }
  if (n_ports == 0) return;
  if (w.rigid == &m && w.ports.size() == n_ports) {
    // They are there, from the evaluation before.
  } else if (m.n_s == 0) {
    w.ports.resize(n_ports);
    for (std::size_t k = 0; k < n_ports; ++k) {
      w.ports[k].p = m.rigid_ports[k].p.template cast<S>();
      w.ports[k].p1.setConstant(S(0.0));
      w.ports[k].p2.setConstant(S(0.0));
      w.ports[k].J.resize(3, 0);
    }
  } else {
    part.points(m.ports, w.q_s, w.q_s_dot, w.ports, w.counters);
  }
  if constexpr (std::is_same_v<S, double>)
    if (m.local != nullptr) displace_ports(m, w);
  w.port_x.resize(n_ports);
  w.port_x_dot.resize(n_ports);
  if (m.loaded) w.port_force.assign(n_ports, Vec3<S>::Constant(S(0.0)));
  for (std::size_t k = 0; k < n_ports; ++k) {
    w.port_x[k] = w.c + w.R * w.ports[k].p;  // Eq. (1)
    if (prescribed) {
      w.port_x_dot[k] = prescribed->velocity(prescribed->R * m.rigid_ports[k].p).template cast<S>();
      continue;
    }
    if (m.q0 < 0) {
      w.port_x_dot[k].setConstant(S(0.0));
      continue;
    }
    const Vec3<S> turning = w.v_r.template segment<3>(3).cross(w.ports[k].p);
    w.port_x_dot[k] = w.R * (w.v_r.template head<3>() + turning + w.ports[k].p1);  // Eq. (9)
  }
}

// mass: M and g_q, Eq. (11); of a rigid part M stays from evaluation to evaluation
template <class S>
void masses(const PartModel& m, PartWorkspace<S>& w) {
  const Vec3<S> omega = w.v_r.template segment<3>(3);
  if constexpr (std::is_same_v<S, double>)
    if (m.local != nullptr) {
      m.local->masses(*m.part, w.q_s, w.v_r, *w.local, w.counters);
      w.inertia.mass = m.part->total_mass();
      w.inertia.moment = w.local->moment;
      return;
    }
  if constexpr (std::is_same_v<S, double>)
    if (w.rigid == &m) return Part::rigid_force(omega, w.inertia, w.counters);
  m.part->inertia(w.q_s, w.q_s_dot, omega, w.inertia, w.counters);
}

// elasticity and damping of the global parameters of a part
template <class S>
void elastic_forces(const PartModel& m, double t, PartWorkspace<S>& w) {
  const Part& part = *m.part;
  const int n = m.n_s;
  const MatX<S>& M = mass_matrix(w);
  const bool damped = part.alpha() > 0 || part.beta() > 0;
  const VecMax<double> rest = m.rest_at(t);
  VecMax<S> stretch(n);
  for (int k = 0; k < n; ++k) stretch[k] = w.q_s[k] - rest[k];
  const auto& K = part.K_s();
  for (int i = 0; i < n; ++i) {
    S elastic(0.0), damping(0.0);
    for (int k = 0; k < n; ++k) {
      elastic += stretch[k] * K(i, k);
      if (damped) damping += w.q_s_dot[k] * (M(6 + i, 6 + k) * part.alpha() + part.beta() * K(i, k));
    }
    w.f[6 + i] -= elastic + damping;  // Eq. (11): -K (q - rest) - D qdot
    w.power[static_cast<int>(Work::damping)] -= damping * w.q_s_dot[i];
    if (m.actuated)
      w.power[static_cast<int>(Work::actuation)] -= elastic * part.parameters().moving(i).rest.at(t).d;
  }
  if (part.continuum() != nullptr)
    w.power[static_cast<int>(Work::damping)] +=
        part.continuum()->add_force(part, w.q_s, w.q_s_dot, part.beta(), w.f.tail(n), w.counters);
}

// power of gravity that changes, -m g_dot . x of the mass centre
template <class S>
void change_gravity(const PartModel& m, const TimeVector& gravity, double t, PartWorkspace<S>& w) {
  const Vec3<Taylor2<double>> g = gravity.at(t);
  Vec3<S> m_x = w.c * S(m.part->total_mass());
  if (m.local == nullptr)
    m_x += w.R * w.inertia.moment;
  else if constexpr (std::is_same_v<S, double>)
    m_x += w.R * m.local->motion(w.v_r, *w.local).moment;
  for (int k = 0; k < 3; ++k) w.power[static_cast<int>(Work::actuation)] -= m_x[k] * g[k].d;
}

// forces of a part alone: inertial, gravity, elasticity and damping of its global parameters, drag
template <class S>
void own_forces(const PartModel& m, const Vec3<double>& gravity, double t, PartWorkspace<S>& w,
                ThreadPool* pool) {
  const int n = m.n_s;
  if constexpr (std::is_same_v<S, double>)
    if (m.local != nullptr) {
      w.f.setZero(6 + n);
      if (n > 0) elastic_forces<S>(m, t, w);
      m.local->forces(w.v_r, w.R.transpose() * gravity, m.drag, *w.local, pool);
      w.power[static_cast<int>(Work::damping)] += w.local->damping;
      w.power[static_cast<int>(Work::drag)] += w.local->drag;
      return;
    }
  w.f = w.inertia.g_q;
  const Vec3<S> g_body = w.R.transpose() * gravity.template cast<S>();
  const MatX<S>& M = w.inertia.M;
  // Gravity acts like an acceleration of the frame: f = M (g, 0, 0).
  for (int i = 0; i < 6 + n; ++i)
    for (int k = 0; k < 3; ++k) w.f[i] += M(i, k) * g_body[k];
  if (n > 0) elastic_forces<S>(m, t, w);
  if (m.drag > 0) {
    for (int i = 0; i < 6 + n; ++i) {
      S momentum(0.0);
      for (int k = 0; k < 6 + n; ++k) momentum += M(i, k) * w.v_r[k];
      w.f[i] -= momentum * m.drag;
      w.power[static_cast<int>(Work::drag)] -= momentum * w.v_r[i] * m.drag;
    }
  }
}

// f_q = L^T f of the forces gathered at the ports, Eq. (11)
template <class S>
void gather_port_forces(const PartModel& m, PartWorkspace<S>& w) {
  for (std::size_t k = 0; k < m.ports.size(); ++k) {
    const Vec3<S> f = w.R.transpose() * w.port_force[k];
    w.f.template head<3>() += f;
    w.f.template segment<3>(3) += w.ports[k].p.cross(f);
    w.f.tail(m.n_s) += w.ports[k].J.transpose().lazyProduct(f);
    if constexpr (std::is_same_v<S, double>)
      if (m.local != nullptr) m.local->push(m.node_weights[k], f, *w.local);
  }
}

bool any_held(const PartWorkspace<double>& w) {
  if (w.local) return w.local->held.any();
  return w.rigid != nullptr ? w.rigid->rigid_factor.any_held() : w.factor.any_held();
}

void factor_mass(const PartModel& m, PartWorkspace<double>& w) {
  if (m.local != nullptr) {
    if (m.island < 0 && m.n_s == 0) return;  // nothing can push on it at once
    m.local->compliance(m.shared, *w.local);
    w.inertia.M = w.local->A_inverse;
    return;
  }
  w.rigid = m.n_s == 0 ? &m : nullptr;
  if (w.stiffening > 0) w.inertia.M.bottomRightCorner(m.n_s, m.n_s) += w.stiffening * m.part->K_s();
  if (w.rigid == nullptr) w.factor.compute(w.inertia.M, m.inertia_floor);
}

void take_factor(const Model& model, int i, Workspace<double>& work) {
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(i)];
  factor_mass(model.parts()[static_cast<std::size_t>(i)], w);
  work.held[static_cast<std::size_t>(i)] = any_held(w) ? 1 : 0;
}

/// a_r of a part that deforms locally, with the d_ddot at its joints, and the d_ddot of all of it.
void accelerate_locally(const PartModel& m, PartWorkspace<double>& w) {
  m.local->accelerations(w.a_r, *w.local);
  if (!m.shared.empty()) {
    VecX<double> buffer;
    const VecX<double> a_r = w.a_r;
    w.a_r.resize(m.n_x());
    w.a_r << a_r, at_points(m.shared, m.local->at_nodes(w.local->d_ddot.data(), buffer));
  }
  w.local->a_free = w.a_r;
}

/// The rows of the limits that parameters of a group's part i rest at.
template <class F>
void for_each_rest(const PartModel& m, const std::int8_t* at_limit, const PartWorkspace<double>& w, int i,
                   F&& act) {
  for (int k = 0; k < m.n_s; ++k)
    if (at_limit[k] != 0 && w.v_r[6 + k] == 0 && !w.held(6 + k))
      act(OneSidedRow{i, k, at_limit[k] < 0 ? 1.0 : -1.0, 0});
}

// limits: parameters that rest at a limit are pressed onto it by forces >= 0. These forces do no work; what
// moves at a limit is the integrator's to stop, by an impulse.
void press(const Model& model, int part, const State& modes, Workspace<double>& work) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(part)];
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(part)];
  w.pressed.clear();
  bool any = false;
  for_each_rest(m, modes.at_limit.data() + m.limit0, w, 0, [&](const OneSidedRow&) { any = true; });
  if (!any) return;
  const Group<double, kMaxVelocities> group(model, work, part);
  OneSidedRows<kMaxVelocities> rows(group);
  for_each_rest(m, modes.at_limit.data() + m.limit0, w, 0, [&](const OneSidedRow& row) { rows.add(row); });
  w.a_r = rows.meet(w.a_r);
  rows.for_each_pushed([&](const OneSidedRow& row, double) { w.pressed.push_back(row.k); });
}

/// The same for a derivative: the pressed parameters have no acceleration.
template <class S>
void hold_pressed(const Model& model, int part, const std::vector<int>& pressed, Workspace<S>& work) {
  if (pressed.empty()) return;
  VecX<S>& a_r = work.parts[static_cast<std::size_t>(part)].a_r;
  const Group<S, kMaxVelocities> group(model, work, part);
  const int n = static_cast<int>(pressed.size());
  MatMax<S> W(n, n);
  VecMax<S> lambda(n);
  std::vector<VecMax<S>> responses;
  for (const int k : pressed) responses.push_back(group.response({0, k, 1, 0}));
  for (int i = 0; i < n; ++i) {
    const int k = pressed[static_cast<std::size_t>(i)];
    lambda[i] = -a_r[6 + k];
    for (int j = 0; j < n; ++j) W(i, j) = responses[static_cast<std::size_t>(j)][6 + k];
  }
  SymmetricFactor<S> factor;
  factor.compute(W, VecX<double>::Zero(n));
  factor.solve(lambda);
  for (int i = 0; i < n; ++i) a_r += responses[static_cast<std::size_t>(i)] * lambda[i];
}

/// Accelerations of a part by its forces, as if there were no joints.
template <class S>
void accelerate(const Model& model, int i, const State* modes, const Workspace<double>* fixed_modes,
                Workspace<S>& work) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(i)];
  PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(i)];
  w.a_r = w.f;
  if constexpr (std::is_same_v<S, double>) {
    take_factor(model, i, work);
    if (m.local != nullptr)
      accelerate_locally(m, w);
    else
      w.solve_mass(w.a_r);
    if (modes != nullptr && m.island < 0) press(model, i, *modes, work);
  } else {
    w.factor.compute(w.inertia.M, m.inertia_floor);
    w.factor.solve(w.a_r);
    if (fixed_modes != nullptr && m.island < 0)
      hold_pressed<S>(model, i, fixed_modes->parts[static_cast<std::size_t>(i)].pressed, work);
  }
}

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
    work.rigid[k].used = modes != nullptr && hold_.projected &&
                         std::all_of(island.joints.begin(), island.joints.end(), [&](int j) {
                           return modes->joints[static_cast<std::size_t>(j)] == JointMode::closed;
                         });
  }
  work.one_by_one = model_->lone_parts();
  for (const Island& island : model_->islands()) {
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

  choose_rigid_islands(rates_only ? modes : nullptr, work);
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
  if (!model.joints().empty()) join<S>(t, modes, fixed_modes, std::ref(evaluate_part), work);
  if constexpr (std::is_same_v<S, double>)
    for (std::size_t k = 0; k < work.rigid.size(); ++k)
      if (work.rigid[k].used)
        model.rigid_islands()[k].accelerate(model, q, v, gravity, work.joints.rank, work, work.rigid[k]);
  auto finish = [&](int i) {
    const PartModel& m = parts[static_cast<std::size_t>(i)];
    if (m.q0 < 0) return;
    const PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(i)];
    work.power += w.power;
    work.v_dot.template segment<3>(m.v0) = w.R * w.a_r.template head<3>();
    work.v_dot.segment(m.v0 + 3, 3 + m.n_s) = w.a_r.segment(3, 3 + m.n_s);
    if constexpr (std::is_same_v<S, double>)
      if (m.local != nullptr) {
        auto d_ddot = work.v_dot.segment(m.v0 + 6 + m.n_s, m.n_d());
        d_ddot = w.local->d_ddot;
        // What joints and limits push.
        if (w.a_r != w.local->a_free)
          m.local->push_all(m.shared, w.local->A_inverse * (w.a_r - w.local->a_free), *w.local, d_ddot);
      }
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
void Dynamics::join(double t, const State* modes, const Workspace<double>* fixed_modes,
                    const PlacePart& evaluate_part, Workspace<S>& work) const {
  const Model& model = *model_;
  ConstraintWorkspace<S>& joints = work.joints;
  size_joints(work);
  joints.lambda.setConstant(S(0.0));
  if (modes != nullptr) {
    const Stabilization& rule = model.body().stabilization;
    joints.modes = modes->joints;
    joints.gains = rule.gains(modes->h, hold_.step_consistent);
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
  joints.stabilise_closed = !hold_.projected;
  auto solve = [&](int i) {
    const Island& island = model.islands()[static_cast<std::size_t>(i)];
    if (is_rigid(island, work)) return;
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

VecX<double> Dynamics::jvp(double t, const VecX<double>& q, const VecX<double>& v,
                           const StateDirection& along, const Workspace<double>& work,
                           Workspace<Dual<1>>& dual_work) const {
  for (const PartModel& m : model_->parts())
    if (m.local != nullptr)
      throw std::logic_error("no derivative of the accelerations of part '" + m.part->name() +
                             "', which deforms locally");
  using D = Dual<1>;
  auto dual = [](const VecX<double>& x, const VecX<double>& dx) {
    VecX<D> r(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      r[i] = D(x[i]);
      r[i].d[0] = dx[i];
    }
    return r;
  };
  evaluate<D>(t, dual(q, along.q), dual(v, along.v), nullptr, &work, false, dual_work);
  VecX<double> d(dual_work.v_dot.size());
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = dual_work.v_dot[i].d[0];
  return d;
}

VecX<double> Dynamics::jvp(const State& state, const StateDirection& along) const {
  Workspace<double> work;
  Workspace<Dual<1>> dual_work;
  accelerations(state.time(), state.q, state.v, state, work);
  return jvp(state.time(), state.q, state.v, along, work, dual_work);
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

}  // namespace pliant
