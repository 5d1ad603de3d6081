// The stages of the evaluation of one part, in the order of sections 2 and 3 of the paper:
//   1 positions      evaluate_positions()      Eqs. (1)-(3), (5), (7)-(9); x_dot = L q_dot in place_ports()
//   2 mass           evaluate_mass()           M and g_q of Eq. (11)
//   3 forces         evaluate_own_forces()     g_q - K (q - rest) - D v of Eq. (11), gravity, drag
//                    add_port_forces()         f_q = L^T f of the loads, Eq. (11)
//   5 accelerations  accelerate_freely()       a = M^-1 f, as if there were no joints
// Stage 4, the joints, is in constraint/constraints.h.
#pragma once

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <pliant/body/constraint/group.h>
#include <pliant/body/constraint/one_sided_rows.h>
#include <pliant/body/stages/evaluation.h>
#include <pliant/body/step_failure.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/math/rotation.h>

namespace pliant::detail {

/// Returns the energies and momenta of a part with local deformation. Throws InvertedElement, with the name
/// of the part, if an element is inverted.
inline LocalMotion local_motion(const PartModel& m, const PartWorkspace<double>& w) {
  return with_name_of_part(m.part->name(), [&] { return m.local->motion(w.v_r, *w.local); });
}

// Stage 1: positions.

/// Computes c, R, q_s, q_s_dot and v_r of a part at time t (s). Returns the prescribed motion of the part, or
/// std::nullopt if its motion is not prescribed.
template <class S>
std::optional<MovingFrame> place_frame(const PartModel& m, double t, const VecX<S>& q, const VecX<S>& v,
                                       PartWorkspace<S>& w) {
  std::optional<MovingFrame> prescribed;
  if (m.q0 < 0) {
    if (m.motion != nullptr) prescribed = m.motion->at(t);
    w.c = (prescribed ? prescribed->c : m.part->c0()).template cast<S>();
    w.R = (prescribed ? prescribed->R : m.R0).template cast<S>();
    w.q_s.resize(0);
    w.q_s_dot.resize(0);
    w.v_r.resize(0);
    return prescribed;
  }
  w.c = q.template segment<3>(m.q0);
  w.R = rotation<S>(q[m.q0 + 3], q[m.q0 + 4], q[m.q0 + 5], q[m.q0 + 6]);
  w.q_s = q.segment(m.q0 + 7, m.n_s);
  w.q_s_dot = v.segment(m.v0 + 6, m.n_s);
  w.v_r.resize(6 + m.n_s);
  w.v_r.template head<3>() = w.R.transpose() * v.template segment<3>(m.v0);
  w.v_r.tail(3 + m.n_s) = v.segment(m.v0 + 3, 3 + m.n_s);
  return prescribed;
}

/// Sets the factor, and its rate, of all elastic laws of the local deformation of a part. name: the part, for
/// the message. Throws NumericalFailure if the factor is negative or not finite.
inline void set_law_factor(const std::string& name, double t, const Taylor2<double>& factor,
                           LocalWorkspace& work) {
  if (!(factor.v >= 0) || !std::isfinite(factor.v)) {
    std::ostringstream message;
    message << "the factor of the local stiffness of part '" << name << "' is " << factor.v
            << "; expected a number of at least 0";
    throw NumericalFailure(message.str(), t);
  }
  work.law_factor = factor.v;
  work.law_factor_rate = factor.d;
}

/// Evaluates d and d_dot of a part that deforms locally, Eq. (5), at time t (s).
template <class S>
void place_local(const PartModel& m, double t, const VecX<S>& q, const VecX<S>& v, PartWorkspace<S>& w) {
  if constexpr (std::is_same_v<S, double>) {
    if (m.local == nullptr) return;
    if (!w.local) w.local = m.local->workspace();
    w.local->place(q.data() + m.q0 + 7 + m.n_s, v.data() + m.v0 + 6 + m.n_s, m.n_d());
    if (const TimeFunction* factor = m.part->local_factor(); factor != nullptr)
      set_law_factor(m.part->name(), t, factor->at(t), *w.local);
    m.local->positions(*m.part, w.q_s, w.v_r, *w.local, w.counters);
  }
}

/// Adds d and d_dot at the ports to p and its rate, Eq. (2).
inline void displace_ports(const PartModel& m, PartWorkspace<double>& w) {
  VecX<double> d_buffer, d_dot_buffer;
  const auto d = m.local->at_nodes(w.local->d.data(), d_buffer),
             d_dot = m.local->at_nodes(w.local->d_dot.data(), d_dot_buffer);
  for (std::size_t k = 0; k < m.ports.size(); ++k) {
    const NodeWeights& at = m.node_weights[k];
    for (std::size_t i = 0; i < at.node.size(); ++i) {
      w.ports[k].p += at.weight[i] * d.row(at.node[i]).transpose();
      w.ports[k].p1 += at.weight[i] * d_dot.row(at.node[i]).transpose();
    }
  }
}

/// Evaluates p, p_dot, J and J_dot q_s_dot at the ports, body frame.
template <class S>
void evaluate_ports(const PartModel& m, PartWorkspace<S>& w) {
  const auto n_ports = m.ports.size();
  // The ports of a rigid part stay in the workspace from one evaluation to the next.
  const bool constant = w.rigid == &m && w.ports.size() == n_ports;
  if (!constant && m.n_s == 0) {
    w.ports.resize(n_ports);
    for (std::size_t k = 0; k < n_ports; ++k) {
      w.ports[k].p = m.rigid_ports[k].p.template cast<S>();
      w.ports[k].p1.setConstant(S(0.0));
      w.ports[k].p2.setConstant(S(0.0));
      w.ports[k].J.resize(3, 0);
    }
  } else if (!constant) {
    m.part->points(m.ports, w.q_s, w.q_s_dot, w.ports, w.counters);
  }
  if constexpr (std::is_same_v<S, double>)
    if (m.local != nullptr) displace_ports(m, w);
}

/// Computes positions and velocities of the ports in the world, Eqs. (1) and (9).
template <class S>
void place_ports(const PartModel& m, const std::optional<MovingFrame>& prescribed, PartWorkspace<S>& w) {
  const auto n_ports = m.ports.size();
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

/// Stage 1: frame, parameters, local coordinates and attachment points of a part at (t, q, v).
template <class S>
void evaluate_positions(const PartModel& m, double t, const VecX<S>& q, const VecX<S>& v,
                        PartWorkspace<S>& w) {
  const std::optional<MovingFrame> prescribed = place_frame<S>(m, t, q, v, w);
  place_local<S>(m, t, q, v, w);
  if (m.ports.empty()) return;
  evaluate_ports<S>(m, w);
  place_ports<S>(m, prescribed, w);
}

// Stage 2: mass.

/// Sets the constant mass of a rigid part.
inline void set_rigid_mass(const PartModel& m, PartWorkspace<double>& w) {
  const Inertia<double>& constant = m.rigid_mass->inertia;
  w.rigid = &m;
  w.inertia.mass = constant.mass;
  w.inertia.moment = constant.moment;
}

/// Stage 2: M and g_q of Eq. (11). A rigid part has constant M, mass and first moment.
/// A part that deforms locally has its masses from LocalDeformation::masses(), and no g_q: stage 3 adds the
/// inertial forces.
template <class S>
void evaluate_mass(const PartModel& m, PartWorkspace<S>& w) {
  const Vec3<S> omega = w.v_r.template segment<3>(3);
  if constexpr (std::is_same_v<S, double>)
    if (m.local != nullptr) {
      m.local->masses(*m.part, w.q_s, w.v_r, *w.local, w.counters);
      w.inertia.mass = m.part->total_mass();
      w.inertia.moment = w.local->moment;
      return;
    }
  if constexpr (std::is_same_v<S, double>)
    if (m.rigid_mass != nullptr) {
      set_rigid_mass(m, w);
      return Part::rigid_force(m.rigid_mass->inertia, omega, w.inertia.g_q, w.counters);
    }
  m.part->evaluate_inertia(w.q_s, w.q_s_dot, omega, w.inertia, w.counters);
}

// Stage 3: forces.

/// Subtracts K (q_s - rest) + D q_s_dot from the forces, and adds the powers of damping and actuation to the
/// power of the part. If the part has a continuum energy, also adds the force and damping of this energy.
template <class S>
void add_elastic_forces(const PartModel& m, double t, PartWorkspace<S>& w) {
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
    w.f[6 + i] -= elastic + damping;  // Eq. (11): -K (q - rest) - D q_dot
    w.power[static_cast<int>(Work::damping)] -= damping * w.q_s_dot[i];
    if (m.actuated)
      w.power[static_cast<int>(Work::actuation)] -= elastic * part.parameters().moving(i).rest.at(t).d;
  }
  if (part.continuum() != nullptr)
    w.power[static_cast<int>(Work::damping)] +=
        part.continuum()->add_force(part, w.q_s, w.q_s_dot, part.beta(), w.f.tail(n), w.counters);
}

/// Returns the power -g_dot . m_x, W, at time t (s) of a gravity g that changes in time. m_x: mass times
/// position of the centre of mass, kg m, world.
template <class S>
S gravity_power(const TimeVector& gravity, double t, const Vec3<S>& m_x) {
  const Vec3<Taylor2<double>> g = gravity.at(t);
  S power(0.0);
  for (int k = 0; k < 3; ++k) power -= m_x[k] * g[k].d;
  return power;
}

/// Adds the power of a gravity that changes in time to the powers of a part.
template <class S>
void add_gravity_power(const PartModel& m, const TimeVector& gravity, double t, PartWorkspace<S>& w) {
  Vec3<S> m_x = w.c * S(m.part->total_mass());
  if (m.local == nullptr)
    m_x += w.R * w.inertia.moment;
  else if constexpr (std::is_same_v<S, double>)
    m_x += w.R * local_motion(m, w).moment;
  w.power[static_cast<int>(Work::actuation)] += gravity_power<S>(gravity, t, m_x);
}

/// Subtracts nu M v, the drag, from the forces and adds its power.
template <class S>
void add_drag(const PartModel& m, PartWorkspace<S>& w) {
  if (!(m.drag > 0)) return;
  const MatX<S>& M = w.M();
  for (int i = 0; i < 6 + m.n_s; ++i) {
    S momentum(0.0);
    for (int k = 0; k < 6 + m.n_s; ++k) momentum += M(i, k) * w.v_r[k];
    w.f[i] -= momentum * m.drag;
    w.power[static_cast<int>(Work::drag)] -= momentum * w.v_r[i] * m.drag;
  }
}

/// Stage 3, forces of a part without its loads: inertial forces g_q, gravity, elasticity and damping of the
/// global parameters, and drag; for a part that deforms locally, also the forces of its local deformation.
/// gravity: m/s^2, world. pool: threads for the elements of the part.
template <class S>
void evaluate_own_forces(const PartModel& m, const Vec3<double>& gravity, double t, PartWorkspace<S>& w,
                         ThreadPool* pool) {
  const int n = m.n_s;
  if constexpr (std::is_same_v<S, double>)
    if (m.local != nullptr) {
      w.f.setZero(6 + n);
      if (n > 0) add_elastic_forces<S>(m, t, w);
      m.local->forces(w.v_r, w.R.transpose() * gravity, m.drag, *w.local, pool);
      w.power[static_cast<int>(Work::damping)] += w.local->damping;
      w.power[static_cast<int>(Work::drag)] += w.local->drag;
      w.power[static_cast<int>(Work::actuation)] += w.local->actuation;
      return;
    }
  w.f = w.inertia.g_q;  // Eq. (11): g_q enters the equation of motion here
  const Vec3<S> g_body = w.R.transpose() * gravity.template cast<S>();
  const MatX<S>& M = w.M();
  // Gravity acts like an acceleration of the frame: f = M (g, 0, 0).
  for (int i = 0; i < 6 + n; ++i)
    for (int k = 0; k < 3; ++k) w.f[i] += M(i, k) * g_body[k];
  if (n > 0) add_elastic_forces<S>(m, t, w);
  add_drag<S>(m, w);
}

/// Stage 3, loads: adds f_q = L^T f of the forces at the ports, Eq. (11).
template <class S>
void add_port_forces(const PartModel& m, PartWorkspace<S>& w) {
  for (std::size_t k = 0; k < m.ports.size(); ++k) {
    const Vec3<S> f = w.R.transpose() * w.port_force[k];
    w.f.template head<3>() += f;
    w.f.template segment<3>(3) += w.ports[k].p.cross(f);
    w.f.tail(m.n_s) += w.ports[k].J.transpose().lazyProduct(f);
    if constexpr (std::is_same_v<S, double>)
      if (m.local != nullptr) m.local->push(m.node_weights[k], f, *w.local);
  }
}

// Stage 5: accelerations of the part alone.

/// Returns whether any velocity of a part has no inertia now.
inline bool has_inertialess_velocity(const PartWorkspace<double>& w) {
  if (w.local) return w.local->without_inertia.any();
  return w.rigid != nullptr ? w.rigid->rigid_mass->factor.any_excluded() : w.factor.any_excluded();
}

/// Factors M of a part, to which PartWorkspace::stiffening adds a term. M of a rigid part has a constant
/// factor. M of a part that deforms locally is computed here if a joint or a limit can push on the part.
inline void factor_mass(const PartModel& m, PartWorkspace<double>& w) {
  if (m.local != nullptr) {
    if (m.island < 0 && m.n_s == 0) return;  // neither a joint nor a limit can push on the part
    m.local->compliance(m.joint_points, *w.local);
    w.inertia.M = w.local->A_inverse;
    return;
  }
  if (m.rigid_mass != nullptr) return;
  if (m.part->has_diagonal_mass()) {
    MatX<double> diagonal = w.inertia.M.diagonal().asDiagonal();
    if (w.stiffening > 0) diagonal.bottomRightCorner(m.n_s, m.n_s) += w.stiffening * m.part->K_s();
    return w.factor.compute(diagonal, m.inertia_floor);
  }
  if (w.stiffening > 0) w.inertia.M.bottomRightCorner(m.n_s, m.n_s) += w.stiffening * m.part->K_s();
  w.factor.compute(w.inertia.M, m.inertia_floor);
}

/// Factors M of part i and records in work.without_inertia whether the part has a velocity without inertia.
inline void factor_part_mass(const Model& model, int i, Workspace<double>& work) {
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(i)];
  factor_mass(model.parts()[static_cast<std::size_t>(i)], w);
  work.without_inertia[static_cast<std::size_t>(i)] = has_inertialess_velocity(w) ? 1 : 0;
}

/// For a part that deforms locally, computes w.a_r and appends the accelerations of d at the part's joints to
/// it. Also computes the second derivatives d_ddot of all local coordinates.
inline void accelerate_local(const PartModel& m, PartWorkspace<double>& w, Eigen::Ref<VecX<double>> d_ddot) {
  m.local->accelerations(w.a_r, *w.local, d_ddot);
  if (!m.joint_points.empty()) {
    VecX<double> buffer;
    const VecX<double> a_r = w.a_r;
    w.a_r.resize(m.n_x());
    w.a_r << a_r, at_points(m.joint_points, m.local->at_nodes(d_ddot.data(), buffer));
  }
  w.local->a_free = w.a_r;
}

/// Calls act(row) for each parameter of a part that is at a limit, has a rate of exactly 0 and has inertia.
/// i: number of the part in its group. at_limit: the entries of the part in State::at_limit.
template <class Act>
void for_each_limit_at_rest(const PartModel& m, const std::int8_t* at_limit, const PartWorkspace<double>& w,
                            int i, Act&& act) {
  for (int k = 0; k < m.n_s; ++k)
    if (at_limit[k] != 0 && w.v_r[6 + k] == 0 && !w.without_inertia(6 + k))
      act(OneSidedRow{i, k, at_limit[k] < 0 ? 1.0 : -1.0, 0});
}

/// Adds forces, directed into the range, that keep parameters at a limit with zero rate from passing this
/// limit. The forces do no work. A parameter that moves at its limit is stopped by an impulse of the method
/// of integration.
inline void apply_limits(const Model& model, int part, const State& modes, Workspace<double>& work) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(part)];
  PartWorkspace<double>& w = work.parts[static_cast<std::size_t>(part)];
  const std::int8_t* at_limit = modes.at_limit.data() + m.limit0;
  w.pressed.clear();
  bool any = false;
  for_each_limit_at_rest(m, at_limit, w, 0, [&](const OneSidedRow&) { any = true; });
  if (!any) return;
  const Group<double, kMaxVelocities> group(model, work, part);
  OneSidedRows<kMaxVelocities> rows(group);
  for_each_limit_at_rest(m, at_limit, w, 0, [&](const OneSidedRow& row) { rows.add(row); });
  w.a_r = rows.satisfy(w.a_r);
  rows.for_each_pushed([&](const OneSidedRow& row, double) { w.pressed.push_back(row.k); });
}

/// For the directional derivative (S = Dual<1>): adds the forces that keep the acceleration of every
/// parameter in `pressed` at zero. pressed: numbers of the parameters that a limit pushed.
template <class S>
void keep_pushed_limits(const Model& model, int part, const std::vector<int>& pressed, Workspace<S>& work) {
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

/// Stage 5 of a part: M a = f without joints. On a part without joints, limits act here. On a part of an
/// island, limits act together with the joints, in stage 4.
template <class S>
void accelerate_freely(const Evaluation<S>& e, int i) {
  const PartModel& m = e.part(i);
  PartWorkspace<S>& w = e.part_work(i);
  w.a_r = w.f;
  if constexpr (std::is_same_v<S, double>) {
    factor_part_mass(e.model(), i, e.work);
    if (m.local != nullptr)
      accelerate_local(m, w, e.work.v_dot.segment(m.v0 + 6 + m.n_s, m.n_d()));
    else
      w.solve_mass(w.a_r);
    if (e.modes != nullptr && m.island < 0) apply_limits(e.model(), i, *e.modes, e.work);
  } else {
    if (m.part->has_diagonal_mass())
      w.factor.compute(MatX<S>(w.inertia.M.diagonal().asDiagonal()), m.inertia_floor);
    else
      w.factor.compute(w.inertia.M, m.inertia_floor);
    w.factor.solve(w.a_r);
    if (e.fixed_modes != nullptr && m.island < 0)
      keep_pushed_limits<S>(e.model(), i, e.fixed_modes->parts[static_cast<std::size_t>(i)].pressed, e.work);
  }
}

}  // namespace pliant::detail
