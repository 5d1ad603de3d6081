#include <pliant/part/local_dynamics.h>

#include "node_sums.h"

namespace pliant {

using namespace node_sums;

namespace {

/// H = sum m [I, -[x]x, J]^T [I, -[s]x, J], from its sums: of m, m x, m s, m x s^T and those with J.
struct FrameSums {
  double mass = 0;
  Vec3<double> x = Vec3<double>::Zero(), s = x;
  Mat3<double> xs = Mat3<double>::Zero();
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxGlobal> J, x_J,
      s_J;  ///< sum m J, m x cross J, m s cross J
  MatMax<double, kMaxGlobal> JJ;

  MatMax<double> matrix() const {
    const auto n_s = J.cols();
    MatMax<double> H(6 + n_s, 6 + n_s);
    H.topLeftCorner<3, 3>() = mass * Mat3<double>::Identity();
    H.block<3, 3>(0, 3) = -skew(s);
    H.block<3, 3>(3, 0) = skew(x);
    H.block<3, 3>(3, 3) = xs.trace() * Mat3<double>::Identity() - xs.transpose();
    H.block(0, 6, 3, n_s) = J;
    H.block(6, 0, n_s, 3) = J.transpose();
    H.block(3, 6, 3, n_s) = x_J;
    H.block(6, 3, n_s, 3) = s_J.transpose();
    H.block(6, 6, n_s, n_s) = JJ;
    return H;
  }
};

/// P and 2 Wdot^T d_dot + Wddot^T d of the global parameters, from derivatives of the jets along each.
void shape_rates(const Part& part, const LocalDeformation& local, const VecX<double>& q_s,
                 const VecX<double>& q_s_dot, const LocalWorkspace& w, MatMax<double>& P,
                 VecMax<double>& rates) {
  using D = Dual<1>;
  const auto n_s = static_cast<int>(q_s.size());
  const Eigen::Index n = local.n_nodes();
  const bool moving = any(q_s_dot);
  constexpr int kBlock = 8;
  std::array<Jet<Dual<1, Pack>>, kBlock> jets;
  for (int j = 0; j < n_s; ++j) {
    VecMax<D> q(n_s), rate(n_s);
    for (int k = 0; k < n_s; ++k) {
      q[k] = D(q_s[k]);
      rate[k] = D(q_s_dot[k]);
    }
    q[j].d[0] = 1;
    const ParameterValues<D> values = part.parameters().expand<D>(q, rate);
    std::array<Pack, kMaxGlobal> of_d, of_d_dot;
    of_d.fill(Pack(0.0));
    of_d_dot.fill(Pack(0.0));
    Pack of_s2(0.0);
    const auto packs = static_cast<int>(local.packs().size());
    for (int first = 0; first < packs; first += kBlock) {
      const int count = std::min(kBlock, packs - first);
      JetBatch<Dual<1, Pack>> batch{jets.data(), count, 0, moving ? Level::rates : Level::jacobian};
      part.jets(values, local.packs().data() + first, batch);
      for (int i = 0; i < count; ++i) {
        const FourNodes four((first + i) * Eigen::Index{Pack::kLanes}, n);
        const Pack m = four.load(local.inertia().data());
        const Vec3<Pack> md = times(m, four.load(w.d.data(), n)), mv = times(m, four.load(w.d_dot.data(), n));
        const Jet<Dual<1, Pack>>& jet = jets[static_cast<std::size_t>(i)];
        for (int k = 0; k < n_s; ++k) {
          const auto at = static_cast<std::size_t>(k);
          for (int r = 0; r < 3; ++r) {
            of_d[at] += jet.J[at][r].d[0] * md[r];
            of_d_dot[at] += jet.J[at][r].d[0] * mv[r];
          }
        }
        if (moving)
          for (int r = 0; r < 3; ++r) of_s2 += jet.s2[r].d[0] * md[r];
      }
    }
    for (int i = 0; i < n_s; ++i) {
      P(6 + i, 6 + j) = sum(of_d[static_cast<std::size_t>(i)]);
      rates[6 + i] += 2 * q_s_dot[j] * sum(of_d_dot[static_cast<std::size_t>(i)]);
    }
    if (moving) rates[6 + j] += sum(of_s2);
  }
}

}  // namespace

void local_positions(const Part& part, const LocalDeformation& local, const VecX<double>& q_s,
                     const VecX<double>& q_s_dot, LocalWorkspace& w, Counters& counters) {
  const Eigen::Index n = local.n_nodes();
  const auto n_s = static_cast<int>(q_s.size());
  w.x.resize(local.n_d());
  if (n_s == 0) {
    if (w.s.rows() != n) w.s = local.mesh().X;
    nodes(w.x, n) = w.s + nodes(w.d, n);
    w.u = nodes(w.d_dot, n);
  } else {
    const bool moving = any(q_s_dot);
    w.s.resize(n, 3);
    w.J.resize(3 * n, n_s);
    w.s1.setZero(n, 3);
    w.s2.setZero(n, 3);
    const ParameterValues<double> values = part.parameters().expand<double>(q_s, q_s_dot);
    constexpr int kBlock = 8;
    std::array<Jet<Pack>, kBlock> jets;
    const auto packs = static_cast<int>(local.packs().size());
    for (int first = 0; first < packs; first += kBlock) {
      const int count = std::min(kBlock, packs - first);
      JetBatch<Pack> batch{jets.data(), count, 0, moving ? Level::rates : Level::jacobian};
      part.jets(values, local.packs().data() + first, batch);
      for (int i = 0; i < count; ++i) {
        const FourNodes four((first + i) * Eigen::Index{Pack::kLanes}, n);
        const Jet<Pack>& jet = jets[static_cast<std::size_t>(i)];
        four.store(w.s.data(), n, jet.s);
        if (moving) {
          four.store(w.s1.data(), n, jet.s1);
          four.store(w.s2.data(), n, jet.s2);
        }
        for (int k = 0; k < n_s; ++k)
          four.store(w.J.data() + 3 * n * k, n, jet.J[static_cast<std::size_t>(k)]);
      }
    }
    counters.jacobian_points += n;
    counters.rate_points += moving ? n : 0;
    nodes(w.x, n) = w.s + nodes(w.d, n);
    w.u = w.s1 + nodes(w.d_dot, n);
  }
  const Eigen::Index own = local.n_d() - 3 * n;
  w.x.tail(own) = w.d.tail(own);
}

void local_masses(const Part& part, const LocalDeformation& local, const VecX<double>& q_s,
                  const VecX<double>& q_s_dot, LocalWorkspace& w, Counters& counters) {
  const Eigen::Index n = local.n_nodes();
  const auto n_s = static_cast<int>(q_s.size());
  const double* mass = local.inertia().data();
  FrameSums sums;
  sums.J.resize(3, n_s);
  sums.x_J.resize(3, n_s);
  sums.s_J.resize(3, n_s);
  sums.JJ.resize(n_s, n_s);
  FrameSums still = sums;  // the same with x = s
  VectorSum mx, ms;
  OuterSum xs, ss;
  Pack total(0.0);
  for_each_four(n, [&](const FourNodes& four) {
    const Pack m = four.load(mass);
    const Vec3<Pack> x = four.load(w.x.data(), n), s = four.load(w.s.data(), n), m_s = times(m, s);
    total += m;
    mx.add(times(m, x));
    ms.add(m_s);
    xs.add(x, m_s);
    ss.add(s, m_s);
  });
  for (int k = 0; k < n_s; ++k) {
    VectorSum J;
    OuterSum xJ, sJ;
    std::array<Pack, kMaxGlobal> JJ;
    JJ.fill(Pack(0.0));
    for_each_four(n, [&](const FourNodes& four) {
      const Vec3<Pack> mJ = times(four.load(mass), four.load(column(w, n, k), n));
      J.add(mJ);
      xJ.add(four.load(w.x.data(), n), mJ);
      sJ.add(four.load(w.s.data(), n), mJ);
      for (int j = 0; j <= k; ++j) JJ[static_cast<std::size_t>(j)] += mJ.dot(four.load(column(w, n, j), n));
    });
    sums.J.col(k) = J.total();
    sums.x_J.col(k) = axial(xJ.total());
    sums.s_J.col(k) = axial(sJ.total());
    for (int j = 0; j <= k; ++j) sums.JJ(j, k) = sums.JJ(k, j) = sum(JJ[static_cast<std::size_t>(j)]);
  }
  sums.mass = still.mass = sum(total);
  sums.x = w.moment = mx.total();
  sums.s = still.x = still.s = ms.total();
  sums.xs = xs.total();
  still.xs = ss.total();
  still.J = sums.J;
  still.x_J = still.s_J = sums.s_J;
  still.JJ = sums.JJ;
  w.H0 = still.matrix();

  w.rates.setZero(6 + n_s);
  MatMax<double> P = MatMax<double>::Zero(6 + n_s, 6 + n_s);
  if (n_s > 0) {
    // W^T d: rows of rotation sum m s x d, of parameters sum m J^T d.
    OuterSum s1v, s2d;
    const bool moving = any(q_s_dot);
    if (moving)
      for_each_four(n, [&](const FourNodes& four) {
        const Pack m = four.load(mass);
        s1v.add(four.load(w.s1.data(), n), times(m, four.load(w.d_dot.data(), n)));
        s2d.add(four.load(w.s2.data(), n), times(m, four.load(w.d.data(), n)));
      });
    // J x d = d (J cross) : sum m J x d = sum m s x J - sum m x cross J.
    P.block(3, 6, 3, n_s) = sums.s_J - sums.x_J;
    if (moving) w.rates.segment<3>(3) = 2 * axial(s1v.total()) + axial(s2d.total());
    shape_rates(part, local, q_s, q_s_dot, w, P, w.rates);
  }
  w.scale = w.H0.diagonal().cwiseSqrt().cwiseInverse();
  const MatMax<double> K = sums.matrix() - P.transpose();
  w.factor.compute(w.scale.asDiagonal() * K * w.scale.asDiagonal());
  w.condition = 1 / w.factor.rcond();
  ++counters.mass_matrices;
}

void local_forces(const LocalDeformation& local, const VecX<double>& v_r, const Vec3<double>& g, double nu,
                  LocalWorkspace& w, ThreadPool* pool) {
  const Eigen::Index n = local.n_nodes(), n_d = local.n_d();
  const VecMax<double> v = v_r;
  const FrameMotion frame(v, w, n);
  const Vec3<Pack> gravity = spread(g);
  const bool curved = w.s2.rows() == n;
  Pack square(0.0);
  w.f.resize(n_d);
  w.f.tail(n_d - 3 * n).setZero();
  for_each_four(n, [&](const FourNodes& four) {
    const Vec3<Pack> p = four.load(w.x.data(), n), u = four.load(w.u.data(), n);
    const Pack m = four.load(local.inertia().data());
    const Vec3<Pack> spin = frame.omega.cross(p);
    Vec3<Pack> turn;  // omega x p + 2 u
    for (int r = 0; r < 3; ++r) turn[r] = spin[r] + u[r] + u[r];
    Vec3<Pack> b = frame.omega.cross(turn);
    if (curved) b = plus(b, four.load(w.s2.data(), n));
    Vec3<Pack> force;
    for (int r = 0; r < 3; ++r) force[r] = m * (gravity[r] - b[r]);
    if (nu > 0) {
      const Vec3<Pack> velocity = plus(plus(frame.c, spin), u);
      for (int r = 0; r < 3; ++r) force[r] -= m * Pack(nu) * velocity[r];
      square += m * velocity.dot(velocity);
    }
    four.store(w.f.data(), n, force);
  });
  w.drag = -nu * sum(square);
  w.f_d.setZero(n_d);
  w.buffers.resize(local.energies().size());
  w.damping = 0;
  for (std::size_t k = 0; k < local.energies().size(); ++k) {
    const NodalEnergy& energy = *local.energies()[k];
    if (energy.of() == NodalEnergy::Of::displacement)
      energy.add_force(w.d, w.f_d, w.buffers[k], pool);
    else
      energy.add_force(w.x, w.f, w.buffers[k], pool);
  }
  auto damp = [&](NodalEnergy::Of of, const VecX<double>& x, const VecX<double>& x_dot, VecX<double>& f) {
    VecX<double>& damping = w.force;
    damping.setZero(n_d);
    for (std::size_t k = 0; k < local.energies().size(); ++k)
      if (local.energies()[k]->of() == of)
        local.energies()[k]->add_viscous_force(x, x_dot, damping, w.buffers[k], pool);
    w.damping += local.beta() * damping.dot(x_dot);
    f += local.beta() * damping;
  };
  if (local.beta() > 0) {
    damp(NodalEnergy::Of::displacement, w.d, w.d_dot, w.f_d);
    w.x_dot.resize(n_d);
    nodes(w.x_dot, n) = w.u;
    w.x_dot.tail(n_d - 3 * n) = w.d_dot.tail(n_d - 3 * n);
    damp(NodalEnergy::Of::position, w.x, w.x_dot, w.f);
  }
  if (local.alpha() > 0) {
    w.damping -= local.alpha() * w.d_dot.dot(local.inertia().cwiseProduct(w.d_dot));
    w.f_d -= local.alpha() * local.inertia().cwiseProduct(w.d_dot);
  }
}

void push_nodes(const LocalDeformation& local, const NodeWeights& at, const Vec3<double>& force,
                LocalWorkspace& w) {
  auto f = nodes(w.f_d, local.n_nodes());
  for (std::size_t i = 0; i < at.node.size(); ++i) f.row(at.node[i]) += at.weight[i] * force.transpose();
}

void local_accelerations(const LocalDeformation& local, VecX<double>& f_r, LocalWorkspace& w) {
  const Eigen::Index n = local.n_nodes();
  const auto n_s = static_cast<int>(f_r.size()) - 6;
  w.kappa = generalised(w.x.data(), w.f_d.data(), w, n, n_s) - f_r;
  w.kappa = w.solve(w.kappa);
  w.force = w.f + w.f_d;
  VecMax<double> a = generalised(w.s.data(), w.force.data(), w, n, n_s) - w.H0 * w.kappa + w.rates;
  a = w.solve_transposed(a);
  f_r = a;
  w.d_ddot = local.mobility().cwiseProduct(w.force);
  const FrameMotion pull(w.kappa, w, n), frame(a, w, n);
  for_each_four(n, [&](const FourNodes& four) {
    Vec3<Pack> d = four.load(w.d_ddot.data(), n);
    const Vec3<Pack> p = four.load(w.x.data(), n), s = four.load(w.s.data(), n);
    const Vec3<Pack> by_kappa = pull.rigid(s), by_frame = frame.rigid(p);
    for (int r = 0; r < 3; ++r) d[r] -= by_kappa[r] + by_frame[r];
    if (n_s > 0) {
      const Vec3<Pack> k = pull.shape(four), f = frame.shape(four);
      for (int r = 0; r < 3; ++r) d[r] -= k[r] + f[r];
    }
    four.store(w.d_ddot.data(), n, d);
  });
}

Eigen::Matrix<double, 6, 6> local_inertia(const LocalDeformation& local, const LocalWorkspace& w) {
  FrameSums sums;
  const Nodes x = nodes(w.x, local.n_nodes());
  const VecX<double>& m = local.mesh().mass;
  sums.mass = m.sum();
  sums.x = sums.s = x.transpose() * m;
  sums.xs = x.transpose() * m.asDiagonal() * x;
  sums.J.resize(3, 0);
  sums.x_J.resize(3, 0);
  sums.s_J.resize(3, 0);
  sums.JJ.resize(0, 0);
  return sums.matrix();
}

VecMax<double> frame_share(const LocalDeformation& local, const Nodes& a, const LocalWorkspace& w) {
  const Eigen::Index n = local.n_nodes();
  const Nodes ma = local.mesh().mass.asDiagonal() * a;
  return generalised(w.s.data(), ma.data(), w, n, static_cast<int>(w.H0.rows()) - 6);
}

Nodes frame_velocities(const LocalDeformation& local, const VecMax<double>& v_r, const LocalWorkspace& w) {
  const Eigen::Index n = local.n_nodes();
  const FrameMotion frame(v_r, w, n);
  Nodes v(n, 3);
  for_each_four(n, [&](const FourNodes& four) {
    four.store(v.data(), n, plus(frame.rigid(four.load(w.x.data(), n)), frame.shape(four)));
  });
  return v;
}

Nodes node_velocities(const LocalDeformation& local, const VecMax<double>& v_r, const LocalWorkspace& w) {
  return frame_velocities(local, v_r, w) + nodes(w.d_dot, local.n_nodes());
}

LocalMotion local_motion(const LocalDeformation& local, const VecX<double>& v_r, const LocalWorkspace& w) {
  const Eigen::Index n = local.n_nodes();
  const VecMax<double> v = v_r;
  const FrameMotion frame(v, w, n);
  VectorSum P, L, moment;
  Pack twice(0.0);
  for_each_four(n, [&](const FourNodes& four) {
    const Pack m = four.load(local.inertia().data());
    const Vec3<Pack> p = four.load(w.x.data(), n);
    const Vec3<Pack> velocity = plus(frame.rigid(p), four.load(w.u.data(), n));
    const Vec3<Pack> momentum = times(m, velocity);
    twice += momentum.dot(velocity);
    P.add(momentum);
    L.add(p.cross(momentum));
    moment.add(times(m, p));
  });
  const Eigen::Index own = local.n_d() - 3 * n;
  LocalMotion motion{0.5 * sum(twice), 0, P.total(), L.total(), moment.total()};
  motion.kinetic += 0.5 * w.d_dot.tail(own).dot(local.inertia().tail(own).cwiseProduct(w.d_dot.tail(own)));
  for (const auto& energy : local.energies())
    motion.elastic += energy->energy(energy->of() == NodalEnergy::Of::displacement ? w.d : w.x);
  return motion;
}

}  // namespace pliant
