// The stages of the evaluation of a part, read like section 3 of the paper: positions -> mass -> forces ->
// limits -> accelerations.
#pragma once

#include <algorithm>
#include <optional>
#include <vector>

#include <pliant/body/constraint/group.h>
#include <pliant/body/constraint/one_sided_rows.h>
#include <pliant/body/dynamics.h>
#include <pliant/math/rotation.h>

namespace pliant {

/// Adds the local deformation at the ports to their positions and velocities.
inline void displace_ports(const PartModel& m, PartWorkspace<double>& w) {
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
      w.local->place(q.data() + m.q0 + 7 + m.n_s, v.data() + m.v0 + 6 + m.n_s, m.n_d());
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

inline bool any_held(const PartWorkspace<double>& w) {
  if (w.local) return w.local->held.any();
  return w.rigid != nullptr ? w.rigid->rigid_factor.any_held() : w.factor.any_held();
}

inline void factor_mass(const PartModel& m, PartWorkspace<double>& w) {
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

inline void take_factor(const Model& model, int i, Workspace<double>& work) {
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(i)];
  factor_mass(model.parts()[static_cast<std::size_t>(i)], w);
  work.held[static_cast<std::size_t>(i)] = any_held(w) ? 1 : 0;
}

/// a_r of a part that deforms locally, with the d_ddot at its joints, and the d_ddot of all of it.
inline void accelerate_locally(const PartModel& m, PartWorkspace<double>& w,
                               Eigen::Ref<VecX<double>> d_ddot) {
  m.local->accelerations(w.a_r, *w.local, d_ddot);
  if (!m.shared.empty()) {
    VecX<double> buffer;
    const VecX<double> a_r = w.a_r;
    w.a_r.resize(m.n_x());
    w.a_r << a_r, at_points(m.shared, m.local->at_nodes(d_ddot.data(), buffer));
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
inline void press(const Model& model, int part, const State& modes, Workspace<double>& work) {
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
      accelerate_locally(m, w, work.v_dot.segment(m.v0 + 6 + m.n_s, m.n_d()));
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

}  // namespace pliant
