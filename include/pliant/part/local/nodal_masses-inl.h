// Function bodies of NodalDeformation: positions and masses (nodal_deformation.h, and
// include/pliant/part/local/README.md). Forces and accelerations are in nodal_forces-inl.h.
//   positions()        p = s + d, Eq. (2), in place_nodes()
//   masses()           M of Eq. (11) at d = 0, and the reference conditions
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

/// Adds the contributions of the global parameters to W^T d, H, P and the rates, without the terms that
/// add_shape_derivatives() adds. W^T d has the rows sum m s x d for theta and sum m J^T d for the parameters.
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

/// Factors scale K scale, where scale H0 scale has a unit diagonal. For a parameter without inertia, the row
/// and the column of K become those of the unit matrix, and the entry of the rates becomes 0.
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

PLIANT_INLINE Eigen::Matrix<double, 6, 6> NodalDeformation::rigid_inertia(const LocalWorkspace& work) const {
  const NodalWorkspace& w = of(work);
  return detail::inertia_at_positions(w.x.data(), inertia_.data(), w, n_nodes(), 0);
}

}  // namespace pliant
