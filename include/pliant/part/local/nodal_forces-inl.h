// Function bodies of NodalDeformation: forces and accelerations (nodal_deformation.h, and
// include/pliant/part/local/README.md):
//   forces()           g_q of Eq. (11), gravity, drag; add_elasticity(): -K q_d of Eq. (11), damping
//   push()             f_q = L^T f of a force at a material point, Eq. (11)
//   accelerations()    a_r and d_ddot
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/local/node_sums.h>

namespace pliant {

PLIANT_INLINE void NodalDeformation::forces(const VecX<double>& v_r, const Vec3<double>& g, double nu,
                                            LocalWorkspace& work, ThreadPool* pool) const {
  using namespace node_sums;
  NodalWorkspace& w = of(work);
  add_elasticity(w, pool);
  // One loop adds inertial forces, gravity and drag to the elastic forces, and computes sum G^T F_d and
  // sum G0^T F.
  const Eigen::Index n = n_nodes(), n_s = v_r.size() - 6;
  const VecMax<double> v = v_r;
  const FrameMotion frame(v, w, n);
  const Vec3<Pack> gravity = spread(g);
  const bool curved = w.s2.rows() == n;
  Pack square(0.0);
  VectorSum f_d, f, torque_d, torque;
  w.force.resize(n_d());
  for_each_four(n, [&](const auto& four) {
    const Vec3<Pack> p = four.load(w.x.data(), n), u = four.load(w.rates_of_p(n), n);
    const Pack m = four.load(inertia_.data());
    const Vec3<Pack> spin = cross(frame.omega, p);
    // g_q of Eq. (11): b = omega x (omega x p + 2 u) + Jdot q_s_dot.
    Vec3<Pack> spin_2u;
    for (int r = 0; r < 3; ++r) spin_2u[r] = spin[r] + u[r] + u[r];
    Vec3<Pack> b = cross(frame.omega, spin_2u);
    if (curved) b = plus(b, four.load(w.s2.data(), n));
    const Vec3<Pack> on_d = four.load(w.f_d.data(), n);
    Vec3<Pack> all = on_d;
    if (of_positions_) all = plus(all, four.load(w.f.data(), n));
    for (int r = 0; r < 3; ++r) all[r] += m * (gravity[r] - b[r]);
    if (nu > 0) {
      const Vec3<Pack> velocity = plus(plus(frame.c, spin), u);
      for (int r = 0; r < 3; ++r) all[r] -= m * Pack(nu) * velocity[r];
      square += m * velocity.dot(velocity);
    }
    four.store(w.force.data(), n, all);
    f_d.add(on_d);
    f.add(all);
    torque_d.add(cross(p, on_d));
    torque.add(cross(four.load(w.s.data(), n), all));
  });
  const Eigen::Index own = n_d() - 3 * n;
  w.force.tail(own) = w.f_d.tail(own);
  if (of_positions_) w.force.tail(own) += w.f.tail(own);
  w.drag = -nu * sum(square);
  w.frame_force_d.resize(6 + n_s);
  w.frame_force_all.resize(6 + n_s);
  w.frame_force_d.head<3>() = f_d.total();
  w.frame_force_d.segment<3>(3) = torque_d.total();
  w.frame_force_all.head<3>() = f.total();
  w.frame_force_all.segment<3>(3) = torque.total();
  for (int k = 0; k < n_s; ++k) {
    w.frame_force_d[6 + k] = along_column(w.f_d.data(), w, n, k);
    w.frame_force_all[6 + k] = along_column(w.force.data(), w, n, k);
  }
}

PLIANT_INLINE void NodalDeformation::add_elasticity(NodalWorkspace& w, ThreadPool* pool) const {
  const Eigen::Index size = n_d();
  w.f_d.setZero(size);
  if (of_positions_) w.f.setZero(size);
  w.buffers.resize(energies_.size());
  for (std::size_t k = 0; k < energies_.size(); ++k) {
    const NodalEnergy& energy = *energies_[k];
    if (energy.of() == NodalEnergy::Of::displacement)
      energy.add_force(w.d, w.f_d, w.buffers[k], pool);
    else
      energy.add_force(w.x, w.f, w.buffers[k], pool);
  }
  w.damping = 0;
  if (beta() > 0) add_viscous_forces(w, pool);
  if (w.law_factor != 1) scale_elasticity(w);
  w.actuation = w.law_factor_rate != 0 ? w.law_factor_rate * elastic_energy(w) : 0;
  if (alpha() > 0) {
    w.damping -= alpha() * w.d_dot.dot(inertia_.cwiseProduct(w.d_dot));
    w.f_d -= alpha() * inertia_.cwiseProduct(w.d_dot);
  }
}

PLIANT_INLINE void NodalDeformation::scale_elasticity(NodalWorkspace& w) const {
  w.f_d *= w.law_factor;
  if (of_positions_) w.f *= w.law_factor;
  w.damping *= w.law_factor;
}

PLIANT_INLINE double NodalDeformation::elastic_energy(const NodalWorkspace& w) const {
  double sum = 0;
  for (const auto& energy : energies_)
    sum += energy->of() == NodalEnergy::Of::displacement ? energy->energy(w.d) : energy->energy(w.x);
  return sum;
}

PLIANT_INLINE void NodalDeformation::add_viscous_forces(NodalWorkspace& w, ThreadPool* pool) const {
  const Eigen::Index n = n_nodes(), size = n_d();
  auto damp = [&](NodalEnergy::Of of, const Coordinates& x, const Coordinates& x_dot, VecX<double>& f) {
    VecX<double>& damping = w.force;  // scratch storage here; forces() overwrites it later
    damping.setZero(size);
    for (std::size_t k = 0; k < energies_.size(); ++k)
      if (energies_[k]->of() == of) energies_[k]->add_viscous_force(x, x_dot, damping, w.buffers[k], pool);
    w.damping += beta() * damping.dot(x_dot);
    f += beta() * damping;
  };
  damp(NodalEnergy::Of::displacement, w.d, w.d_dot, w.f_d);
  if (of_positions_) {
    w.x_dot.resize(size);
    w.x_dot.head(3 * n) = Eigen::Map<const VecX<double>>(w.rates_of_p(n), 3 * n);
    w.x_dot.tail(size - 3 * n) = w.d_dot.tail(size - 3 * n);
    damp(NodalEnergy::Of::position, w.x, w.x_dot, w.f);
  }
}

PLIANT_INLINE void NodalDeformation::push(const NodeWeights& at, const Vec3<double>& force,
                                          LocalWorkspace& work) const {
  using namespace node_sums;
  NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  for (std::size_t i = 0; i < at.node.size(); ++i) {
    const Eigen::Index node = at.node[i];
    const Vec3<double> share = at.weight[i] * force;
    auto at_node = [&](const double* columns) {
      return Vec3<double>(columns[node], columns[node + n], columns[node + 2 * n]);
    };
    nodes(w.force, n).row(node) += share.transpose();
    w.frame_force_d.head<3>() += share;
    w.frame_force_d.segment<3>(3) += at_node(w.x.data()).cross(share);
    w.frame_force_all.head<3>() += share;
    w.frame_force_all.segment<3>(3) += at_node(w.s.data()).cross(share);
    for (int k = 0; k + 6 < w.frame_force_d.size(); ++k) {
      const double along = at_node(column(w, n, k)).dot(share);
      w.frame_force_d[6 + k] += along;
      w.frame_force_all[6 + k] += along;
    }
  }
}

PLIANT_INLINE void NodalDeformation::accelerations(VecX<double>& f_r, LocalWorkspace& work,
                                                   Eigen::Ref<VecX<double>> d_ddot) const {
  using namespace node_sums;
  NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  w.kappa = w.solve(w.frame_force_d - f_r);
  VecMax<double> loads = w.frame_force_all + w.rates;
  loads.noalias() -= w.H0 * w.kappa;
  const VecMax<double> a = w.solve_transposed(loads);
  f_r = a;
  // d_ddot = F / m - G0 kappa - G a_r
  const FrameMotion by_conditions(w.kappa, w, n), frame(a, w, n);
  for_each_four(n, [&](const auto& four) {
    const Pack mobility = four.load(mobility_.data());
    Vec3<Pack> d = times(mobility, four.load(w.force.data(), n));
    const Vec3<Pack> by_kappa = by_conditions.rigid(four.load(w.s.data(), n)),
                     by_frame = frame.rigid(four.load(w.x.data(), n));
    for (int r = 0; r < 3; ++r) d[r] -= by_kappa[r] + by_frame[r];
    if (a.size() > 6) {
      const Vec3<Pack> k = by_conditions.shape(four), shape = frame.shape(four);
      for (int r = 0; r < 3; ++r) d[r] -= k[r] + shape[r];
    }
    four.store(d_ddot.data(), n, d);
  });
  const Eigen::Index own = n_d() - 3 * n;
  d_ddot.tail(own) = mobility_.tail(own).cwiseProduct(w.force.tail(own));
}

}  // namespace pliant
