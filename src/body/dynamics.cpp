#include <pliant/body/dynamics.h>

#include <cmath>
#include <sstream>

#include <pliant/solve/complementarity.h>

namespace pliant {

namespace {

/// R of a quaternion (w, x, y, z), of any length.
template <class S>
Mat3<S> rotation(const S& w, const S& x, const S& y, const S& z) {
  const S two = S(2.0) / (w * w + x * x + y * y + z * z);
  Mat3<S> R;
  R(0, 0) = S(1.0) - two * (y * y + z * z);
  R(1, 1) = S(1.0) - two * (x * x + z * z);
  R(2, 2) = S(1.0) - two * (x * x + y * y);
  R(0, 1) = two * (x * y - w * z);
  R(1, 0) = two * (x * y + w * z);
  R(0, 2) = two * (x * z + w * y);
  R(2, 0) = two * (x * z - w * y);
  R(1, 2) = two * (y * z - w * x);
  R(2, 1) = two * (y * z + w * x);
  return R;
}

// positions: frames, parameters and attachment points in the world, Eqs. (1) and (9)
template <class S>
void positions(const PartModel& m, const VecX<S>& q, const VecX<S>& v, PartWorkspace<S>& w) {
  const Part& part = *m.part;
  const auto n_ports = m.ports.size();
  if (m.q0 < 0) {
    w.c = part.c0().template cast<S>();
    w.R = m.R0.template cast<S>();
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
  if (n_ports == 0) return;
  if (part.rigid()) {
    w.ports.resize(n_ports);
    for (std::size_t k = 0; k < n_ports; ++k) {
      w.ports[k].p = m.rigid_ports[k].p.template cast<S>();
      w.ports[k].p1.setConstant(S(0.0));
      w.ports[k].J.resize(3, 0);
    }
  } else {
    part.points(m.ports, w.q_s, w.q_s_dot, w.ports, w.counters);
  }
  w.port_x.resize(n_ports);
  w.port_x_dot.resize(n_ports);
  w.port_force.assign(n_ports, Vec3<S>::Constant(S(0.0)));
  for (std::size_t k = 0; k < n_ports; ++k) {
    w.port_x[k] = w.c + w.R * w.ports[k].p;  // Eq. (1)
    if (m.q0 < 0) {
      w.port_x_dot[k].setConstant(S(0.0));
      continue;
    }
    const Vec3<S> turning = w.v_r.template segment<3>(3).cross(w.ports[k].p);
    w.port_x_dot[k] = w.R * (w.v_r.template head<3>() + turning + w.ports[k].p1);  // Eq. (9)
  }
}

// forces of a part alone: inertial, gravity, elasticity and damping of its global parameters, drag
template <class S>
void own_forces(const PartModel& m, const Vec3<double>& gravity, double t, PartWorkspace<S>& w) {
  const Part& part = *m.part;
  const int n = m.n_s;
  w.f = w.inertia.g_q;
  const Vec3<S> g_body = w.R.transpose() * gravity.template cast<S>();
  const MatMax<S>& M = w.inertia.M;
  // Gravity acts like an acceleration of the frame: f = M (g, 0, 0).
  for (int i = 0; i < 6 + n; ++i)
    for (int k = 0; k < 3; ++k) w.f[i] += M(i, k) * g_body[k];

  const bool damped = part.alpha() > 0 || part.beta() > 0;
  VecMax<S> stretch(n);
  for (int k = 0; k < n; ++k) {
    const Parameter& p = part.parameters().moving(k);
    stretch[k] = w.q_s[k] - p.rest.value(t);
  }
  const auto& K = part.K_s();
  for (int i = 0; i < n; ++i) {
    S elastic(0.0), damping(0.0);
    for (int k = 0; k < n; ++k) {
      elastic += stretch[k] * K(i, k);
      if (damped) damping += w.q_s_dot[k] * (M(6 + i, 6 + k) * part.alpha() + part.beta() * K(i, k));
    }
    w.f[6 + i] -= elastic + damping;  // Eq. (11): -K (q - rest) - D qdot
    w.power[static_cast<int>(Work::damping)] -= damping * w.q_s_dot[i];
    const Parameter& p = part.parameters().moving(i);
    if (!p.rest.is_constant()) w.power[static_cast<int>(Work::actuation)] -= elastic * p.rest.at(t).d;
  }
  if (part.drag() > 0) {
    for (int i = 0; i < 6 + n; ++i) {
      S momentum(0.0);
      for (int k = 0; k < 6 + n; ++k) momentum += M(i, k) * w.v_r[k];
      w.f[i] -= momentum * part.drag();
      w.power[static_cast<int>(Work::drag)] -= momentum * w.v_r[i] * part.drag();
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
  }
}

/// M^-1 e_i of a part.
template <class S>
VecMax<S> inverse_column(const SymmetricFactor<S>& factor, int n, int i) {
  VecMax<S> x(n);
  for (int k = 0; k < n; ++k) x[k] = S(k == i ? 1.0 : 0.0);
  factor.solve(x);
  return x;
}

// limits: parameters that rest at a limit are pressed onto it by forces >= 0, found on the small system
// W = C M^-1 C^T. These forces do no work; what moves at a limit is the integrator's to stop, by an impulse.
void press(const PartModel& m, const std::int8_t* at_limit, PartWorkspace<double>& w) {
  w.pressed.clear();
  std::array<int, kMaxGlobal> rows{};
  int n = 0;
  for (int k = 0; k < m.n_s; ++k)
    if (at_limit[k] != 0 && w.v_r[6 + k] == 0 && !w.factor.held(6 + k))
      rows[static_cast<std::size_t>(n++)] = k;
  if (n == 0) return;
  MatMax<double, kMaxLimitRows> W(n, n);
  VecMax<double, kMaxLimitRows> b(n);
  std::array<VecMax<double>, kMaxGlobal> columns;
  for (int j = 0; j < n; ++j) {
    const auto c = static_cast<std::size_t>(j);
    columns[c] = inverse_column<double>(w.factor, 6 + m.n_s, 6 + rows[c]);
    for (int i = 0; i < n; ++i) {
      const int k = rows[static_cast<std::size_t>(i)];
      W(i, j) = at_limit[k] * at_limit[rows[c]] * columns[c][6 + k];
    }
    b[j] = -at_limit[rows[c]] * w.a_r[6 + rows[c]];  // along the admissible direction
  }
  const VecMax<double, kMaxLimitRows> lambda = solve_complementarity(W, b).lambda;
  for (int i = 0; i < n; ++i) {
    if (!(lambda[i] > 0)) continue;
    const auto c = static_cast<std::size_t>(i);
    w.a_r += columns[c] * (-at_limit[rows[c]] * lambda[i]);
    w.pressed.push_back(rows[c]);
  }
  for (const int k : w.pressed) w.a_r[6 + k] = 0;  // to the last bit
}

/// The same for a derivative: the pressed parameters have no acceleration.
template <class S>
void hold_pressed(const PartModel& m, const std::vector<int>& pressed, PartWorkspace<S>& w) {
  if (pressed.empty()) return;
  const int n = static_cast<int>(pressed.size());
  MatMax<S> W(n, n);
  VecMax<S> lambda(n);
  std::vector<VecMax<S>> columns;
  for (const int k : pressed) columns.push_back(inverse_column<S>(w.factor, 6 + m.n_s, 6 + k));
  for (int i = 0; i < n; ++i) {
    const int k = pressed[static_cast<std::size_t>(i)];
    lambda[i] = -w.a_r[6 + k];
    for (int j = 0; j < n; ++j) W(i, j) = columns[static_cast<std::size_t>(j)][6 + k];
  }
  SymmetricFactor<S> factor;
  factor.compute(W, VecMax<double>::Zero(n));
  factor.solve(lambda);
  for (int i = 0; i < n; ++i)
    for (int r = 0; r < 6 + m.n_s; ++r) w.a_r[r] += columns[static_cast<std::size_t>(i)][r] * lambda[i];
}

template <class S>
struct WorldPoint {
  Vec3<S> x, x_dot;
};

}  // namespace

template <class S>
void Dynamics::evaluate(double t, const VecX<S>& q, const VecX<S>& v,
                        const std::vector<std::int8_t>* at_limit, const Workspace<double>* fixed_limits,
                        Workspace<S>& work) const {
  const Model& model = *model_;
  const auto& parts = model.parts();
  work.parts.resize(parts.size());
  work.v_dot.resize(model.n_v());
  work.power.setConstant(S(0.0));
  const int n_parts = static_cast<int>(parts.size());
  auto each_part = [&](auto&& task) {
    if (pool_ != nullptr)
      pool_->run(n_parts, std::ref(task));
    else
      for (int i = 0; i < n_parts; ++i) task(i);
  };

  each_part([&](int i) {
    const PartModel& m = parts[static_cast<std::size_t>(i)];
    PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(i)];
    positions<S>(m, q, v, w);
    w.power.setConstant(S(0.0));
    if (m.q0 < 0) return;
    m.part->inertia(w.q_s, w.q_s_dot, Vec3<S>(w.v_r.template segment<3>(3)), w.inertia, w.counters);
    own_forces<S>(m, model.body().gravity, t, w);
  });

  // forces between parts, in a fixed order
  auto at_port = [&](const PortRef& ref, const Point& point) -> WorldPoint<S> {
    if (ref.part >= 0) {
      const PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(ref.part)];
      return {w.port_x[static_cast<std::size_t>(ref.port)], w.port_x_dot[static_cast<std::size_t>(ref.port)]};
    }
    const Vec3<Taylor2<double>> x = point.world.at(t);
    return {Vec3<S>(S(x[0].v), S(x[1].v), S(x[2].v)), Vec3<S>(S(x[0].d), S(x[1].d), S(x[2].d))};
  };
  auto push = [&](const PortRef& ref, const Vec3<S>& force, double sign) {
    if (ref.part < 0) return;
    work.parts[static_cast<std::size_t>(ref.part)].port_force[static_cast<std::size_t>(ref.port)] +=
        force * S(sign);
  };
  for (const SpringModel& s : model.springs()) {
    const WorldPoint<S> a = at_port(s.a, s.spring->a), b = at_port(s.b, s.spring->b);
    const Vec3<S> d = b.x - a.x, d_dot = b.x_dot - a.x_dot;
    Vec3<S> pull, damping;  // on a, towards b
    if (s.spring->rest_length == 0) {
      pull = d * S(s.spring->stiffness);
      damping = d_dot * S(s.spring->damping);
    } else {
      const S length2 = d.dot(d);
      if (plain(length2) == 0) continue;  // no direction; what is not a number goes on to be found
      const S length = math::sqrt(length2);
      const Vec3<S> along = d / length;
      pull = along * S((length - s.spring->rest_length) * s.spring->stiffness);
      damping = along * S(along.dot(d_dot) * s.spring->damping);
    }
    const Vec3<S> force = pull + damping;
    push(s.a, force, 1);
    push(s.b, force, -1);
    work.power[static_cast<int>(Work::spring_damping)] -= damping.dot(d_dot);
    // The hand that moves an anchor exerts the opposite of the spring's pull on it.
    if (s.a.part < 0) work.power[static_cast<int>(Work::anchors)] -= force.dot(a.x_dot);
    if (s.b.part < 0) work.power[static_cast<int>(Work::anchors)] += force.dot(b.x_dot);
  }
  for (const ForceModel& f : model.forces()) {
    const WorldPoint<S> at = at_port(f.at, f.force->at);
    Vec3<S> force;
    if (f.force->custom) {
      Vec3<double> x, x_dot;
      for (int r = 0; r < 3; ++r) {
        x[r] = plain(at.x[r]);
        x_dot[r] = plain(at.x_dot[r]);
      }
      force = f.force->custom(t, x, x_dot).template cast<S>();
    } else {
      force = f.force->force.value(t).template cast<S>();
      if (f.force->frame == Frame::body)
        force = (work.parts[static_cast<std::size_t>(f.at.part)].R * force).eval();
    }
    push(f.at, force, 1);
    work.power[static_cast<int>(Work::forces)] += force.dot(at.x_dot);
  }
  for (const TorqueModel& m : model.torques()) {
    PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(m.part)];
    if (parts[static_cast<std::size_t>(m.part)].q0 < 0) continue;
    Vec3<S> torque = m.torque->torque.value(t).template cast<S>();
    if (m.torque->frame == Frame::world) torque = (w.R.transpose() * torque).eval();
    w.f.template segment<3>(3) += torque;
    work.power[static_cast<int>(Work::forces)] += torque.dot(w.v_r.template segment<3>(3));
  }

  each_part([&](int i) {
    const PartModel& m = parts[static_cast<std::size_t>(i)];
    if (m.q0 < 0) return;
    PartWorkspace<S>& w = work.parts[static_cast<std::size_t>(i)];
    gather_port_forces<S>(m, w);
    w.a_r = w.f;
    if constexpr (std::is_same_v<S, double>) {
      if (m.part->rigid())
        w.factor = m.rigid_factor;
      else
        w.factor.compute(w.inertia.M, m.inertia_floor);
      w.factor.solve(w.a_r);
      if (at_limit != nullptr) press(m, at_limit->data() + m.limit0, w);
    } else {
      w.factor.compute(w.inertia.M, m.inertia_floor);
      w.factor.solve(w.a_r);
      if (fixed_limits != nullptr)
        hold_pressed<S>(m, fixed_limits->parts[static_cast<std::size_t>(i)].pressed, w);
    }
    work.v_dot.template segment<3>(m.v0) = w.R * w.a_r.template head<3>();
    work.v_dot.segment(m.v0 + 3, 3 + m.n_s) = w.a_r.tail(3 + m.n_s);
  });
  for (const PartWorkspace<S>& w : work.parts) work.power += w.power;
}

void Dynamics::accelerations(double t, const VecX<double>& q, const VecX<double>& v,
                             const std::vector<std::int8_t>& at_limit, Workspace<double>& work) const {
  evaluate<double>(t, q, v, &at_limit, nullptr, work);
}

VecX<double> Dynamics::jvp(double t, const VecX<double>& q, const VecX<double>& v,
                           const StateDirection& along, const Workspace<double>& work,
                           Workspace<Dual<1>>& dual_work) const {
  using D = Dual<1>;
  auto dual = [](const VecX<double>& x, const VecX<double>& dx) {
    VecX<D> r(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      r[i] = D(x[i]);
      r[i].d[0] = dx[i];
    }
    return r;
  };
  evaluate<D>(t, dual(q, along.q), dual(v, along.v), nullptr, &work, dual_work);
  VecX<double> d(dual_work.v_dot.size());
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = dual_work.v_dot[i].d[0];
  return d;
}

VecX<double> Dynamics::jvp(const State& state, const StateDirection& along) const {
  Workspace<double> work;
  Workspace<Dual<1>> dual_work;
  accelerations(state.time(), state.q, state.v, state.at_limit, work);
  return jvp(state.time(), state.q, state.v, along, work, dual_work);
}

void Dynamics::coordinate_rates(const VecX<double>& q, const VecX<double>& v, VecX<double>& q_dot) const {
  q_dot.resize(q.size());
  for (const PartModel& m : model_->parts()) {
    if (m.q0 < 0) continue;
    q_dot.segment<3>(m.q0) = v.segment<3>(m.v0);
    const auto theta = q.segment<4>(m.q0 + 3);
    const auto omega = v.segment<3>(m.v0 + 3);
    auto rate = q_dot.segment<4>(m.q0 + 3);
    rate[0] = -0.5 * (theta[1] * omega[0] + theta[2] * omega[1] + theta[3] * omega[2]);
    rate[1] = 0.5 * (theta[0] * omega[0] + theta[2] * omega[2] - theta[3] * omega[1]);
    rate[2] = 0.5 * (theta[0] * omega[1] + theta[3] * omega[0] - theta[1] * omega[2]);
    rate[3] = 0.5 * (theta[0] * omega[2] + theta[1] * omega[1] - theta[2] * omega[0]);
    q_dot.segment(m.q0 + 7, m.n_s) = v.segment(m.v0 + 6, m.n_s);
  }
}

Ledger Dynamics::ledger(double t, const State& state, Workspace<double>& work) const {
  accelerations(t, state.q, state.v, state.at_limit, work);
  Ledger ledger;
  ledger.work = state.work;
  for (std::size_t i = 0; i < work.parts.size(); ++i) {
    const PartModel& m = model_->parts()[i];
    if (m.q0 < 0) continue;
    const PartWorkspace<double>& w = work.parts[i];
    const VecMax<double> momentum = w.inertia.M * w.v_r;
    ledger.kinetic += 0.5 * w.v_r.dot(momentum);
    const Vec3<double> moment = w.R * w.inertia.moment;
    ledger.gravity -= model_->body().gravity.dot(w.inertia.mass * w.c + moment);
    VecMax<double> stretch(m.n_s);
    for (int k = 0; k < m.n_s; ++k) stretch[k] = w.q_s[k] - m.part->parameters().moving(k).rest.value(t);
    ledger.elastic += 0.5 * stretch.dot(m.part->K_s() * stretch);
    const Vec3<double> P = w.R * momentum.head<3>();
    ledger.momentum += P;
    ledger.angular_momentum += w.c.cross(P) + w.R * momentum.segment<3>(3);
  }
  for (const SpringModel& s : model_->springs()) {
    auto at = [&](const PortRef& ref, const Point& point) -> Vec3<double> {
      return ref.part >= 0
                 ? work.parts[static_cast<std::size_t>(ref.part)].port_x[static_cast<std::size_t>(ref.port)]
                 : point.world.value(t);
    };
    const double stretch = (at(s.b, s.spring->b) - at(s.a, s.spring->a)).norm() - s.spring->rest_length;
    ledger.springs += 0.5 * s.spring->stiffness * stretch * stretch;
  }
  return ledger;
}

void Dynamics::apply_impulse(const PartWorkspace<double>& part, VecMax<double>& impulse) {
  part.factor.solve(impulse);
}

namespace {
/// Which of the forces of a part alone is not finite.
std::string own_term(double t, const PartModel& m, const PartWorkspace<double>& w) {
  const Part& part = *m.part;
  VecMax<double> stretch = w.q_s;
  for (int k = 0; k < m.n_s; ++k) stretch[k] -= part.parameters().moving(k).rest.value(t);
  const VecMax<double> elastic = part.K_s() * stretch, momentum = w.inertia.M * w.v_r;
  const VecMax<double> damping =
      (part.alpha() * w.inertia.M.bottomRightCorner(m.n_s, m.n_s) + part.beta() * part.K_s()) * w.q_s_dot;
  if (!elastic.allFinite()) return "the elastic force K_s (q - rest)";
  if (!damping.allFinite()) return "the damping force D q_dot";
  if (part.drag() > 0 && !(part.drag() * momentum).allFinite()) return "the drag";
  return "the sum of the forces";
}
}  // namespace

std::string Dynamics::diagnose(double t, const VecX<double>& q, const VecX<double>& v,
                               Workspace<double>& work) const {
  for (Eigen::Index i = 0; i < q.size(); ++i)
    if (!std::isfinite(q[i])) return "the coordinate " + model_->coordinate_name(static_cast<int>(i));
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (!std::isfinite(v[i])) return "the velocity " + model_->velocity_name(static_cast<int>(i));
  evaluate<double>(t, q, v, nullptr, nullptr, work);
  auto of_part = [&](std::size_t i) { return " of part '" + model_->parts()[i].part->name() + "'"; };
  for (std::size_t i = 0; i < work.parts.size(); ++i) {
    if (model_->parts()[i].q0 < 0) continue;
    if (!work.parts[i].inertia.M.allFinite()) return "the mass matrix M" + of_part(i);
    if (!work.parts[i].inertia.g_q.allFinite()) return "the inertial force g_q" + of_part(i);
  }
  for (const PartModel& m : model_->parts())
    for (const int k : m.part->parameters().dynamic()) {
      const Parameter& p = m.part->parameters()[k];
      if (!std::isfinite(p.rest.value(t))) return "the rest value of " + m.part->name() + "." + p.name;
    }
  for (const SpringModel& s : model_->springs())
    for (const Point* end : {&s.spring->a, &s.spring->b})
      if (end->part == nullptr && !end->world.value(t).allFinite())
        return "the anchor of spring '" + s.spring->name + "'";
  for (const SpringModel& s : model_->springs())
    for (const PortRef& ref : {s.a, s.b})
      if (ref.part >= 0 && !work.parts[static_cast<std::size_t>(ref.part)]
                                .port_force[static_cast<std::size_t>(ref.port)]
                                .allFinite())
        return "the force of spring '" + s.spring->name + "'";
  for (const ForceModel& f : model_->forces())
    if (!work.parts[static_cast<std::size_t>(f.at.part)]
             .port_force[static_cast<std::size_t>(f.at.port)]
             .allFinite())
      return "the force '" + f.force->name + "'";
  for (const TorqueModel& m : model_->torques())
    if (!m.torque->torque.value(t).allFinite()) return "the torque '" + m.torque->name + "'";
  for (std::size_t i = 0; i < work.parts.size(); ++i) {
    if (model_->parts()[i].q0 < 0) continue;
    if (!work.parts[i].f.allFinite()) return own_term(t, model_->parts()[i], work.parts[i]) + of_part(i);
    if (!work.parts[i].a_r.allFinite()) return "the acceleration" + of_part(i);
  }
  return {};
}

template void Dynamics::evaluate<double>(double, const VecX<double>&, const VecX<double>&,
                                         const std::vector<std::int8_t>*, const Workspace<double>*,
                                         Workspace<double>&) const;

}  // namespace pliant
