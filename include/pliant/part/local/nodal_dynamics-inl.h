// Function bodies of NodalDeformation: the stages of the dynamics with reference conditions
// (nodal_deformation.h, and include/pliant/part/local/README.md):
//   positions()        p = s + d, Eq. (2), in place_nodes()
//   masses()           M of Eq. (11) at d = 0, and the reference conditions
//   forces()           g_q of Eq. (11), gravity, drag; add_elasticity(): -K q_d of Eq. (11), damping
//   push()             f_q = L^T f of a force at a material point, Eq. (11)
//   accelerations()    a_r and d_ddot
#pragma once

#include <algorithm>
#include <array>

#include <pliant/math/header_only.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/local/node_sums.h>
#include <pliant/part/store_jets.h>

namespace pliant {

namespace detail {

/// Returns sum m [I, -[s]x, J]^T [I, -[s]x, J] over n nodes at positions s (at_s); J has n_s columns.
inline MatMax<double> inertia_at_positions(const double* at_s, const double* mass, const NodalWorkspace& w,
                                           Eigen::Index n, int n_s) {
  using namespace node_sums;
  MatMax<double> H(6 + n_s, 6 + n_s);
  VectorSum ms;
  OuterSum ss;
  Pack total(0.0);
  for_each_four(n, [&](const auto& four) {
    const Pack m = four.load(mass);
    const Vec3<Pack> s = four.load(at_s, n), m_s = times(m, s);
    total += m;
    ms.add(m_s);
    ss.add(s, m_s);
  });
  const Mat3<double> outer = ss.total();
  H.topLeftCorner<3, 3>() = sum(total) * Mat3<double>::Identity();
  H.block<3, 3>(3, 0) = skew(ms.total());
  H.block<3, 3>(3, 3) = outer.trace() * Mat3<double>::Identity() - outer;
  for (int k = 0; k < n_s; ++k) {
    VectorSum J;
    OuterSum sJ;
    std::array<Pack, kMaxGlobal> JJ;
    JJ.fill(Pack(0.0));
    for_each_four(n, [&](const auto& four) {
      const Vec3<Pack> mJ = times(four.load(mass), four.load(column(w, n, k), n));
      J.add(mJ);
      sJ.add(four.load(at_s, n), mJ);
      for (int j = 0; j <= k; ++j) JJ[static_cast<std::size_t>(j)] += mJ.dot(four.load(column(w, n, j), n));
    });
    H.block<1, 3>(6 + k, 0) = J.total().transpose();
    H.block<1, 3>(6 + k, 3) = axial(sJ.total()).transpose();
    for (int j = 0; j <= k; ++j) H(6 + k, 6 + j) = sum(JJ[static_cast<std::size_t>(j)]);
  }
  return H.selfadjointView<Eigen::Lower>();
}

/// Computes the positions p = s + d of nodes and, in one pass, sum m d and sum m d s^T.
inline void place_nodes(const double* mass, Eigen::Index n, NodalWorkspace& w) {
  using namespace node_sums;
  VectorSum md;
  OuterSum ds;
  for_each_four(n, [&](const auto& four) {
    const Vec3<Pack> s = four.load(w.s.data(), n), d = four.load(w.d.data(), n),
                     m_d = times(four.load(mass), d);
    four.store(w.x.data(), n, plus(s, d));
    md.add(m_d);
    ds.add(m_d, s);
  });
  w.m_d = md.total();
  w.m_d_s = ds.total();
}

/// The matrices of the reference conditions while they are assembled.
struct ReferenceConditions {
  MatMax<double> K, P;  ///< P = d(W^T d)/dq_s; K = H until P is complete, then K = H - P^T
};

/// Sums over nodes of derivatives of J and Jdot q_s_dot along one parameter q_j.
struct ShapeDerivativeSums {
  /// Sums of m (dJ_k/dq_j)^T d and of m (dJ_k/dq_j)^T d_dot, for each parameter k.
  std::array<Pack, kMaxGlobal> d, d_dot;
  Pack s2 = Pack(0.0);  ///< sum of m (d(Jdot q_s_dot)/dq_j)^T d

  ShapeDerivativeSums() {
    d.fill(Pack(0.0));
    d_dot.fill(Pack(0.0));
  }
  void add(const Jet<Dual<1, Pack>>& jet, const Vec3<Pack>& m_d, const Vec3<Pack>& m_d_dot, int n_s,
           bool moving) {
    for (int k = 0; k < n_s; ++k) {
      const auto at = static_cast<std::size_t>(k);
      for (int r = 0; r < 3; ++r) {
        d[at] += jet.J[at][r].d[0] * m_d[r];
        d_dot[at] += jet.J[at][r].d[0] * m_d_dot[r];
      }
    }
    if (moving)
      for (int r = 0; r < 3; ++r) s2 += jet.s2[r].d[0] * m_d[r];
  }
};

/// Adds the terms with derivatives of J and of Jdot q_s_dot along each parameter to P and to the rates
/// 2 Wdot^T d_dot + Wddot^T d. These terms are in the rows of the global parameters.
inline void add_shape_derivatives(const Part& part, const NodalDeformation& local, const VecX<double>& q_s,
                                  const VecMax<double>& q_s_dot, NodalWorkspace& w, MatMax<double>& P) {
  using namespace node_sums;
  using D = Dual<1>;
  const auto n_s = static_cast<int>(q_s.size());
  const Eigen::Index n = local.n_nodes();
  const bool moving = any_nonzero(q_s_dot);
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
    ShapeDerivativeSums sums;
    const auto packs = static_cast<int>(local.packs().size());
    for (int first = 0; first < packs; first += kBlock) {
      const int count = std::min(kBlock, packs - first);
      JetBatch<Dual<1, Pack>> batch{jets.data(), count, 0, moving ? Level::rates : Level::jacobian};
      part.jets(values, local.packs().data() + first, batch);
      for (int i = 0; i < count; ++i) {
        const FourNodes<> four((first + i) * Eigen::Index{Pack::kLanes}, n);
        const Pack m = four.load(local.inertia().data());
        sums.add(jets[static_cast<std::size_t>(i)], times(m, four.load(w.d.data(), n)),
                 times(m, four.load(w.d_dot.data(), n)), n_s, moving);
      }
    }
    for (int i = 0; i < n_s; ++i) {
      P(6 + i, 6 + j) = sum(sums.d[static_cast<std::size_t>(i)]);
      w.rates[6 + i] += 2 * q_s_dot[j] * sum(sums.d_dot[static_cast<std::size_t>(i)]);
    }
    if (moving) w.rates[6 + j] += sum(sums.s2);
  }
}

/// Adds the contributions of the global parameters to W^T d, H, P and the rates, without those of
/// add_shape_derivatives(). W^T d has the rows sum m s x d for theta and sum m J^T d for the parameters.
inline void add_parameter_rows(const double* mass, const VecMax<double>& q_s_dot, bool linear,
                               NodalWorkspace& w, ReferenceConditions& conditions) {
  using namespace node_sums;
  const Eigen::Index n = w.s.rows();
  const bool moving = any_nonzero(q_s_dot);
  OuterSum s1v, s2d;
  if (moving)
    for_each_four(n, [&](const auto& four) {
      s1v.add(four.load(w.s1.data(), n), times(four.load(mass), four.load(w.d_dot.data(), n)));
    });
  if (moving && !linear)
    for_each_four(n, [&](const auto& four) {
      s2d.add(four.load(w.s2.data(), n), times(four.load(mass), four.load(w.d.data(), n)));
    });
  for (int k = 0; k < static_cast<int>(q_s_dot.size()); ++k) {
    OuterSum dJ;
    for_each_four(n, [&](const auto& four) {
      dJ.add(times(four.load(mass), four.load(w.d.data(), n)), four.load(column(w, n, k), n));
    });
    const Mat3<double> d_J = dJ.total();
    w.violation[6 + k] = d_J.trace();
    conditions.K.block<3, 1>(3, 6 + k) += axial(d_J);
    conditions.P.block<3, 1>(3, 6 + k) = -axial(d_J);
  }
  if (moving) w.rates.segment<3>(3) = 2 * axial(s1v.total()) + axial(s2d.total());
}

/// Factors scale K scale, where scale H0 scale has a unit diagonal. The row and the column of a parameter
/// without inertia are replaced by those of the unit matrix, and its entry of the rates by 0.
inline void factor_conditions(const Part& part, int n_s, MatMax<double>& K, NodalWorkspace& w) {
  w.scale = w.H0.diagonal().cwiseSqrt().cwiseInverse();
  w.without_inertia.reset();
  for (int k = 0; k < n_s; ++k) {
    if (w.H0(6 + k, 6 + k) > part.inertia_floor(k)) continue;
    w.without_inertia.set(static_cast<std::size_t>(6 + k));
    K.row(6 + k).setZero();
    K.col(6 + k).setZero();
    K(6 + k, 6 + k) = w.scale[6 + k] = 1;
    w.rates[6 + k] = 0;
  }
  K = (w.scale.asDiagonal() * K * w.scale.asDiagonal()).eval();
  if (n_s == 0)
    w.factor.emplace<0>(K);
  else
    w.factor.emplace<1>(K);
}

}  // namespace detail

PLIANT_INLINE void NodalDeformation::linear_positions(const VecX<double>& q_s, const VecMax<double>& q_s_dot,
                                                      NodalWorkspace& w) const {
  using namespace node_sums;
  const Eigen::Index n = n_nodes();
  const auto n_s = static_cast<int>(q_s.size());
  if (w.J.rows() != 3 * n) w.J = linear_->J;
  w.s.resize(n, 3);
  w.s1.resize(n, 3);
  w.u.resize(n, 3);
  for_each_four(n, [&](const auto& four) {
    Vec3<Pack> s = four.load(linear_->s_0.data(), n), s1 = Vec3<Pack>::Constant(Pack(0.0));
    for (int k = 0; k < n_s; ++k) {
      const Vec3<Pack> J = four.load(column(w, n, k), n);
      s = plus(s, times(Pack(q_s[k]), J));
      s1 = plus(s1, times(Pack(q_s_dot[k]), J));
    }
    four.store(w.s.data(), n, s);
    four.store(w.s1.data(), n, s1);
    four.store(w.u.data(), n, plus(s1, four.load(w.d_dot.data(), n)));
  });
}

PLIANT_INLINE void NodalDeformation::positions(const Part& part, const VecX<double>& q_s,
                                               const VecX<double>& v_r, LocalWorkspace& work,
                                               Counters& counters) const {
  NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  const auto n_s = static_cast<int>(q_s.size());
  w.x.resize(n_d());
  if (n_s == 0) {
    if (w.s.rows() != n) w.s = mesh_.X;
  } else if (linear_) {
    linear_positions(q_s, v_r.tail(n_s), w);
  } else {
    w.s.resize(n, 3);
    w.J.resize(3 * n, n_s);
    w.s1.setZero(n, 3);
    w.s2.setZero(n, 3);
    store_jets(part, q_s, v_r.tail(n_s), packs_, {n, w.s.data(), w.s1.data(), w.s2.data(), w.J.data()},
               counters);
    w.u = w.s1 + nodes(w.d_dot, n);
  }
  detail::place_nodes(inertia_.data(), n, w);
  const Eigen::Index own = n_d() - 3 * n;
  w.x.tail(own) = w.d.tail(own);
}

PLIANT_INLINE void NodalDeformation::masses(const Part& part, const VecX<double>& q_s,
                                            const VecX<double>& v_r, LocalWorkspace& work,
                                            Counters& counters) const {
  NodalWorkspace& w = of(work);
  const VecMax<double> q_s_dot = v_r.tail(q_s.size());
  const auto n_s = static_cast<int>(q_s.size());
  const double* mass = inertia_.data();
  if (linear_)
    w.H0 = linear_->inertia.mass_matrix(q_s);
  else if (n_s > 0 || w.H0.rows() == 0)
    w.H0 = detail::inertia_at_positions(w.s.data(), mass, w, n_nodes(), n_s);
  w.moment = Vec3<double>(w.H0(5, 1), w.H0(3, 2), w.H0(4, 0)) + w.m_d;
  w.violation.resize(6 + n_s);
  w.violation.head<3>() = w.m_d;
  w.violation.segment<3>(3) = -axial(w.m_d_s);
  // H = sum G^T W, where G differs from G0 by -[d]x.
  detail::ReferenceConditions conditions{w.H0, MatMax<double>::Zero(6 + n_s, 6 + n_s)};
  conditions.K.block<3, 3>(3, 0) += skew(w.m_d);
  conditions.K.block<3, 3>(3, 3) += w.m_d_s.trace() * Mat3<double>::Identity() - w.m_d_s.transpose();

  w.rates.setZero(6 + n_s);
  if (n_s > 0) {
    detail::add_parameter_rows(mass, q_s_dot, linear_.has_value(), w, conditions);
    if (!linear_) detail::add_shape_derivatives(part, *this, q_s, q_s_dot, w, conditions.P);
  }
  conditions.K -= conditions.P.transpose();
  detail::factor_conditions(part, n_s, conditions.K, w);
  ++counters.mass_matrices;
}

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
  if (alpha() > 0) {
    w.damping -= alpha() * w.d_dot.dot(inertia_.cwiseProduct(w.d_dot));
    w.f_d -= alpha() * inertia_.cwiseProduct(w.d_dot);
  }
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

PLIANT_INLINE Eigen::Matrix<double, 6, 6> NodalDeformation::rigid_inertia(const LocalWorkspace& work) const {
  const NodalWorkspace& w = of(work);
  return detail::inertia_at_positions(w.x.data(), inertia_.data(), w, n_nodes(), 0);
}

PLIANT_INLINE NodalDeformation::ConditionViolation NodalDeformation::violation(
    const Eigen::Ref<const Nodes>& d, const Eigen::Ref<const Nodes>& d_dot,
    const LocalWorkspace& work) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  VectorSum md, mv, s_mv;
  OuterSum ds;
  for_each_four(n, [&](const auto& four) {
    const Pack m = four.load(inertia_.data());
    const Vec3<Pack> s = four.load(w.s.data(), n), m_d = times(m, four.load(d.data(), n)),
                     m_v = times(m, four.load(d_dot.data(), n));
    md.add(m_d);
    mv.add(m_v);
    ds.add(m_d, s);
    s_mv.add(cross(s, m_v));
  });
  ConditionViolation violation;
  violation.d_s = ds.total();
  violation.W_d << md.total(), -axial(violation.d_s);
  violation.W_d_dot << mv.total(), s_mv.total();
  return violation;
}

PLIANT_INLINE VecMax<double> NodalDeformation::frame_share(const Eigen::Ref<const Nodes>& a,
                                                           const LocalWorkspace& work) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes(), n_s = w.H0.rows() - 6;
  VecMax<double> on_frame(6 + n_s);
  VectorSum sum_a, s_a;
  for_each_four(n, [&](const auto& four) {
    const Vec3<Pack> ma = times(four.load(inertia_.data()), four.load(a.data(), n));
    sum_a.add(ma);
    s_a.add(cross(four.load(w.s.data(), n), ma));
  });
  on_frame.head<3>() = sum_a.total();
  on_frame.segment<3>(3) = s_a.total();
  for (int k = 0; k < n_s; ++k) {
    Pack along(0.0);
    for_each_four(n, [&](const auto& four) {
      along += four.load(inertia_.data()) * four.load(column(w, n, k), n).dot(four.load(a.data(), n));
    });
    on_frame[6 + k] = sum(along);
  }
  return on_frame;
}

PLIANT_INLINE void NodalDeformation::add_frame_velocities(const VecMax<double>& v_r, double sign,
                                                          const LocalWorkspace& work, const double* from,
                                                          double* to) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  const VecMax<double> v = sign * v_r;
  const FrameMotion frame(v, w, n);
  for_each_four(n, [&](const auto& four) {
    Vec3<Pack> by_frame = frame.rigid(four.load(w.x.data(), n));
    if (v.size() > 6) by_frame = plus(by_frame, frame.shape(four));
    four.store(to, n, plus(four.load(from, n), by_frame));
  });
}

PLIANT_INLINE void NodalDeformation::move_frame(const Vec3<double>& shift, const Mat3<double>& turn, Nodes& p,
                                                Nodes& u) const {
  using namespace node_sums;
  const Eigen::Index n = n_nodes();
  const Vec3<Pack> from = spread(-shift),
                   row[3] = {spread(turn.col(0)), spread(turn.col(1)), spread(turn.col(2))};
  for_each_four(n, [&](const auto& four) {
    const Vec3<Pack> x = plus(four.load(p.data(), n), from), v = four.load(u.data(), n);
    Vec3<Pack> x_now, v_now;
    for (int r = 0; r < 3; ++r) {
      x_now[r] = row[r].dot(x);
      v_now[r] = row[r].dot(v);
    }
    four.store(p.data(), n, x_now);
    four.store(u.data(), n, v_now);
  });
}

PLIANT_INLINE LocalMotion NodalDeformation::motion(const VecX<double>& v_r,
                                                   const LocalWorkspace& work) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  const VecMax<double> v = v_r;
  const FrameMotion frame(v, w, n);
  VectorSum P, L, moment;
  Pack twice(0.0);
  for_each_four(n, [&](const auto& four) {
    const Pack m = four.load(inertia_.data());
    const Vec3<Pack> p = four.load(w.x.data(), n);
    const Vec3<Pack> velocity = plus(frame.rigid(p), four.load(w.rates_of_p(n), n));
    const Vec3<Pack> momentum = times(m, velocity);
    twice += momentum.dot(velocity);
    P.add(momentum);
    L.add(cross(p, momentum));
    moment.add(times(m, p));
  });
  const Eigen::Index own = n_d() - 3 * n;
  LocalMotion all{0.5 * sum(twice), 0, P.total(), L.total(), moment.total()};
  all.kinetic += 0.5 * w.d_dot.tail(own).dot(inertia_.tail(own).cwiseProduct(w.d_dot.tail(own)));
  for (const auto& energy : energies_)
    all.elastic += energy->of() == NodalEnergy::Of::displacement ? energy->energy(w.d) : energy->energy(w.x);
  return all;
}

PLIANT_INLINE LocalDeformation::Bound NodalDeformation::stiffness_bound(const LocalWorkspace& work) const {
  Bound bound;
  for (const auto& energy : energies_) {
    const bool of_d = energy->of() == NodalEnergy::Of::displacement;
    const double omega2 = energy->frequency_bound(of_d ? work.d : of(work).x, inertia_);
    bound.K += omega2;
    bound.D += beta() * omega2;
  }
  return bound;
}

PLIANT_INLINE double NodalDeformation::mobility(const NodeWeights& at) const {
  double sum = 0;
  for (std::size_t k = 0; k < at.node.size(); ++k) sum += at.weight[k] * at.weight[k] * mobility_[at.node[k]];
  return sum;
}

}  // namespace pliant
