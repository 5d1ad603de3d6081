// Function bodies of ModalDeformation: construction, and the stages of the dynamics (modal_deformation.h).
// forces() computes g_q and -K q_d of Eq. (11). K is diagonal, with the squared angular frequencies of the
// modes.
#pragma once

#include <cmath>
#include <functional>
#include <sstream>
#include <string>

#include <Eigen/Geometry>

#include <pliant/math/column_basis.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/math/header_only.h>
#include <pliant/part/axial.h>
#include <pliant/part/local/modal_deformation.h>
#include <pliant/part/local/mode_conditions.h>
#include <pliant/part/store_jets.h>

namespace pliant {

PLIANT_INLINE double ModalWorkspace::condition() const {
  return 1 / factor.rcond();
}

namespace detail {

/// Returns sum m a b^T over spectral nodes. a, b: one row for each spectral node.
template <class A, class B>
Mat3<double> spectral_outer(const VecX<double>& m, const A& a, const B& b) {
  return a.transpose() * m.asDiagonal() * b;
}

}  // namespace detail

PLIANT_INLINE ModalDeformation::ModalDeformation(const Part& part, const LocalSettings& settings,
                                                 ModalBasis basis)
    : LocalDeformation(settings.alpha, settings.beta), basis_(std::move(basis)) {
  mesh_ = std::move(basis_.mesh);
  oscillators_ = oscillators_at(1);
  if (part.n_s() > 0) packs_ = packs_of(basis_.points);
  // The initial amplitudes are the components of an initial field along the modes. The initial changes of the
  // frame and of the parameters are a least-squares fit of the field.
  const MatX<double> G = rest_frame(part, basis_);
  auto project = [&](const std::function<Vec3<double>(const Vec3<double>&)>& field, VecX<double>& on_modes,
                     VecX<double>& on_frame) {
    on_modes.setZero(n_modes());
    if (!field) return;
    Nodes values(basis_.points_at_rest.rows(), 3);
    for (Eigen::Index k = 0; k < values.rows(); ++k)
      values.row(k) = field(basis_.points_at_rest.row(k).transpose()).transpose();
    const VecX<double> d = Nodes(basis_.project * values).reshaped(), m = basis_.mass.replicate(3, 1);
    on_modes = basis_.B.transpose() * m.cwiseProduct(d);
    on_frame = least_squares(m.cwiseSqrt().asDiagonal() * G, m.cwiseSqrt().cwiseProduct(d));
  };
  project(settings.displacement, initial_, initial_frame_);
  project(settings.velocity, initial_rate_, initial_frame_rate_);
  check_start(part, displacements(initial_.data()), initial_rate_);
  if (part.n_s() == 0) {
    basis_.points.clear();
    basis_.points_at_rest.resize(0, 3);
    basis_.project.resize(0, 0);
  }
}

PLIANT_INLINE std::string ModalDeformation::coordinate_name(Eigen::Index k) const {
  return "mode[" + std::to_string(k) + "]";
}
PLIANT_INLINE const char* ModalDeformation::unit(Eigen::Index) const {
  return "m kg^(1/2)";
}

PLIANT_INLINE double ModalDeformation::cost() const {
  constexpr double per_entry_of_B = 0.0005;  // microseconds; six multiplications per entry if n_s = 0
  return per_entry_of_B * static_cast<double>(basis_.B.size());
}

PLIANT_INLINE std::string ModalDeformation::description() const {
  std::ostringstream text;
  const VecX<double> f = basis_.omega2.cwiseMax(0).cwiseSqrt() / (2 * kPi);
  text << n_modes() << " local, modes of " << basis_.made_of << " from " << f[0] << " to " << f[n_modes() - 1]
       << " Hz";
  return text.str();
}

PLIANT_INLINE NodeWeights ModalDeformation::weights(const Part& part, const Material<double>& m) const {
  return basis_.weights(part, m);
}

PLIANT_INLINE Eigen::Map<const Nodes> ModalDeformation::at_nodes(const double* q_d,
                                                                 VecX<double>& buffer) const {
  buffer.noalias() = basis_.B * Eigen::Map<const VecX<double>>(q_d, n_modes());
  return {buffer.data(), n_fields(), 3};
}

PLIANT_INLINE Nodes ModalDeformation::displacements(const double* q_d) const {
  VecX<double> buffer;
  return basis_.shown * at_nodes(q_d, buffer);
}

PLIANT_INLINE Eigen::Matrix3Xd ModalDeformation::displacements(const double* q_d,
                                                               const std::vector<int>& nodes) const {
  VecX<double> buffer;
  const auto d = at_nodes(q_d, buffer);
  Eigen::Matrix3Xd some(3, static_cast<Eigen::Index>(nodes.size()));
  for (Eigen::Index k = 0; k < some.cols(); ++k)
    some.col(k) = (basis_.shown.row(nodes[static_cast<std::size_t>(k)]) * d).transpose();
  return some;
}

PLIANT_INLINE std::unique_ptr<LocalWorkspace> ModalDeformation::workspace() const {
  return std::make_unique<ModalWorkspace>();
}

PLIANT_INLINE void ModalDeformation::project_shape(const Part& part, const VecX<double>& q_s,
                                                   const VecX<double>& v_r, ModalWorkspace& w,
                                                   Counters& counters) const {
  const auto n = static_cast<Eigen::Index>(basis_.points.size());
  w.at_points.setZero(n, ModalWorkspace::kJ + 3 * q_s.size());
  double* const first = w.at_points.data();
  store_jets(part, q_s, v_r.tail(q_s.size()), packs_,
             {n, first + ModalWorkspace::kS * n, first + ModalWorkspace::kS1 * n,
              first + ModalWorkspace::kS2 * n, first + ModalWorkspace::kJ * n},
             counters);
  w.shape.noalias() = basis_.project * w.at_points;
}

PLIANT_INLINE void ModalDeformation::positions(const Part& part, const VecX<double>& q_s,
                                               const VecX<double>& v_r, LocalWorkspace& work,
                                               Counters& counters) const {
  ModalWorkspace& w = of(work);
  w.D.resize(n_fields(), 3);
  w.D_dot.resize(n_fields(), 3);
  w.D.reshaped().noalias() = basis_.B * w.d;
  w.D_dot.reshaped().noalias() = basis_.B * w.d_dot;
  if (q_s.size() > 0) return project_shape(part, q_s, v_r, w, counters);
  if (w.shape.rows() == n_fields()) return;
  w.shape.setZero(n_fields(), ModalWorkspace::kJ);
  w.shape.leftCols<3>() = basis_.X;
}

PLIANT_INLINE void ModalDeformation::masses(const Part& part, const VecX<double>& q_s,
                                            const VecX<double>& v_r, LocalWorkspace& work,
                                            Counters& counters) const {
  ModalWorkspace& w = of(work);
  const VecX<double>& m = basis_.mass;
  const Eigen::Index n = n_fields(), n_s = q_s.size();
  const Vec3<double> omega = v_r.segment<3>(3);
  if (n_s > 0) {
    part.evaluate_inertia(q_s, v_r.tail(n_s), omega, w.undeformed, counters);
  } else {
    if (w.undeformed.M.size() == 0) w.undeformed = part.rest_inertia();
    Part::rigid_force(w.undeformed, omega, w.undeformed.g_q, counters);
  }
  w.H0 = w.undeformed.M;
  w.moment = w.undeformed.moment;
  // Contributions of d to M_rr, with int d dm = 0.
  const Mat3<double> sd = detail::spectral_outer(m, w.s(), w.D), dd = detail::spectral_outer(m, w.D, w.D);
  const Mat3<double> Q = sd + sd.transpose() + dd;
  w.M_rr = w.H0;
  w.M_rr.block<3, 3>(3, 3) += Q.trace() * Mat3<double>::Identity() - Q;
  // The rows of C for theta and q_s are R^T B. If no parameter is dynamic, int s x Phi dm = 0, so that R
  // needs only the part d of p = s + d.
  w.R.setZero(3 * n, 3 + n_s);
  const Nodes mp = n_s > 0 ? Nodes(m.asDiagonal() * (w.D + w.s())) : Nodes(m.asDiagonal() * w.D);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;  // e_i x p
    w.R.col(i).segment(k * n, n) = mp.col(j);
    w.R.col(i).segment(j * n, n) = -mp.col(k);
  }
  for (Eigen::Index k = 0; k < n_s; ++k) {
    const auto J = w.J(k);
    w.R.col(3 + k) = (m.asDiagonal() * J).reshaped();
    const Vec3<double> d_x_J = axial(detail::spectral_outer(m, w.D, J));
    w.M_rr.block<3, 1>(3, 6 + k) += d_x_J;
    w.M_rr.block<1, 3>(6 + k, 3) += d_x_J.transpose();
  }
  w.C.setZero(6 + n_s, n_modes());
  w.C.bottomRows(3 + n_s).noalias() = w.R.transpose() * basis_.B;
  MatMax<double> S = w.M_rr;
  S.bottomRightCorner(3 + n_s, 3 + n_s).noalias() -=
      w.C.bottomRows(3 + n_s) * w.C.bottomRows(3 + n_s).transpose();
  w.scale = w.H0.diagonal().cwiseSqrt().cwiseInverse();
  w.factor.compute(w.scale.asDiagonal() * S * w.scale.asDiagonal());
}

PLIANT_INLINE void ModalDeformation::forces(const VecX<double>& v_r, const Vec3<double>& g, double nu,
                                            LocalWorkspace& work, ThreadPool*) const {
  ModalWorkspace& w = of(work);
  const VecX<double>& m = basis_.mass;
  const Eigen::Index n_s = v_r.size() - 6;
  const Vec3<double> omega = v_r.segment<3>(3);
  w.f_r = w.undeformed.g_q + w.undeformed.M.leftCols<3>() * g;
  w.F.setZero(n_fields(), 3);
  if ((v_r.tail(3 + n_s).array() != 0).any()) {
    // g_q of Eq. (11): b = omega x (omega x p) + 2 omega x (J q_s_dot + d_dot) + Jdot q_s_dot. The terms of s
    // and of d are separate, because f_r already contains the integrals of the terms of s alone
    // (undeformed.g_q).
    const Mat3<double> spin = skew(omega).transpose(), spin2 = spin * spin;  // for row vectors
    const Nodes of_shape = w.s() * spin2 + 2 * w.s1() * spin + w.s2(),
                of_d = w.D * spin2 + 2 * w.D_dot * spin, b = of_shape + of_d;
    w.F.noalias() = -(m.asDiagonal() * b);
    w.f_r.segment<3>(3) -=
        axial(detail::spectral_outer(m, w.s(), of_d)) + axial(detail::spectral_outer(m, w.D, b));
    for (Eigen::Index k = 0; k < n_s; ++k) w.f_r[6 + k] -= detail::spectral_outer(m, w.J(k), of_d).trace();
  }
  if (w.law_factor == 1)
    set_oscillator_forces(oscillators_, w);
  else
    set_oscillator_forces(oscillators_at(w.law_factor), w);
  w.actuation =
      w.law_factor_rate != 0 ? 0.5 * w.law_factor_rate * w.d.dot(basis_.omega2.cwiseProduct(w.d)) : 0;
  w.drag = 0;
  if (nu == 0) return;
  const VecX<double> on_frame = w.M_rr * v_r + w.C * w.d_dot, on_modes = w.C.transpose() * v_r + w.d_dot;
  w.f_r -= nu * on_frame;
  w.f_d -= nu * on_modes;
  w.drag = -nu * (on_frame.dot(v_r) + on_modes.dot(w.d_dot));
}

PLIANT_INLINE void ModalDeformation::set_oscillator_forces(const Oscillators& oscillators,
                                                           ModalWorkspace& w) {
  w.f_d = -(oscillators.omega2.cwiseProduct(w.d) + oscillators.damping.cwiseProduct(w.d_dot));
  w.damping = -w.d_dot.dot(oscillators.damping.cwiseProduct(w.d_dot));
}

PLIANT_INLINE Oscillators ModalDeformation::oscillators_at(double factor) const {
  return {factor * basis_.omega2, (alpha() + factor * beta() * basis_.omega2.array()).matrix()};
}

PLIANT_INLINE void ModalDeformation::push(const NodeWeights& at, const Vec3<double>& force,
                                          LocalWorkspace& work) const {
  for (std::size_t i = 0; i < at.node.size(); ++i)
    of(work).F.row(at.node[i]) += at.weight[i] * force.transpose();
}

PLIANT_INLINE void ModalDeformation::accelerations(VecX<double>& f_r, LocalWorkspace& work,
                                                   Eigen::Ref<VecX<double>> d_ddot) const {
  ModalWorkspace& w = of(work);
  w.force = w.f_d;
  w.force.noalias() += basis_.B.transpose() * w.F.reshaped();
  f_r += w.f_r;
  d_ddot = w.force;
  respond(f_r, d_ddot, w);
}

PLIANT_INLINE void ModalDeformation::respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_modes,
                                             const LocalWorkspace& work) const {
  const ModalWorkspace& w = of(work);
  on_frame.noalias() -= w.C * on_modes;
  on_frame = w.solve(on_frame);
  on_modes.noalias() -= w.C.transpose() * on_frame;
}

PLIANT_INLINE Eigen::Matrix3Xd ModalDeformation::modes_of_node(int node) const {
  Eigen::Matrix3Xd Phi(3, n_modes());
  for (int r = 0; r < 3; ++r)
    Phi.row(r).noalias() = basis_.shown.row(node) * basis_.B.middleRows(r * n_fields(), n_fields());
  return Phi;
}

PLIANT_INLINE MatX<double> ModalDeformation::modes_at(const NodeWeights& at) const {
  MatX<double> P = MatX<double>::Zero(3, n_modes());
  for (int r = 0; r < 3; ++r)
    for (std::size_t i = 0; i < at.node.size(); ++i)
      P.row(r) += at.weight[i] * basis_.B.row(at.node[i] + r * n_fields());
  return P;
}

PLIANT_INLINE MatX<double> ModalDeformation::inertial_compliance(const std::vector<NodeWeights>& points,
                                                                 LocalWorkspace& work) const {
  ModalWorkspace& w = of(work);
  const Eigen::Index n_r = w.M_rr.rows(), n_p = 3 * static_cast<Eigen::Index>(points.size());
  w.P.resize(n_p, n_modes());
  for (std::size_t k = 0; k < points.size(); ++k)
    w.P.middleRows<3>(3 * static_cast<Eigen::Index>(k)) = modes_at(points[k]);
  w.C_P.noalias() = w.C * w.P.transpose();
  const MatX<double> inverse = w.solve(MatX<double>::Identity(n_r, n_r)), coupled = inverse * w.C_P;
  MatX<double> A(n_r + n_p, n_r + n_p);
  A << inverse, -coupled, -coupled.transpose(), w.P * w.P.transpose() + w.C_P.transpose() * coupled;
  return 0.5 * (A + A.transpose());
}

PLIANT_INLINE void ModalDeformation::inertial_push_all(const std::vector<NodeWeights>&, const VecX<double>& g,
                                                       const LocalWorkspace& work,
                                                       Eigen::Ref<VecX<double>> d_dot) const {
  const ModalWorkspace& w = of(work);
  const Eigen::Index n_r = w.M_rr.rows();
  const VecX<double> on_points = g.tail(g.size() - n_r);
  const VecX<double> frame = w.solve(VecX<double>(g.head(n_r) - w.C_P * on_points));
  d_dot.noalias() += w.P.transpose() * on_points;
  d_dot.noalias() -= w.C.transpose() * frame;
}

PLIANT_INLINE Eigen::Matrix<double, 6, 6> ModalDeformation::rigid_inertia(const LocalWorkspace& work) const {
  return of(work).M_rr.topLeftCorner<6, 6>();
}

PLIANT_INLINE LocalMotion ModalDeformation::motion(const VecX<double>& v_r,
                                                   const LocalWorkspace& work) const {
  const ModalWorkspace& w = of(work);
  const VecX<double> momentum = w.M_rr * v_r + w.C * w.d_dot;
  LocalMotion all;
  all.kinetic = 0.5 * (v_r.dot(momentum + w.C * w.d_dot) + w.d_dot.squaredNorm());
  all.elastic = 0.5 * w.law_factor * w.d.dot(basis_.omega2.cwiseProduct(w.d));
  all.momentum = momentum.head<3>();
  all.angular_momentum = momentum.segment<3>(3);
  all.moment = w.moment;
  return all;
}

PLIANT_INLINE LocalDeformation::Bound ModalDeformation::stiffness_bound(const LocalWorkspace& work) const {
  const double highest = work.law_factor * basis_.omega2.maxCoeff();
  return {highest, beta() * highest};
}

PLIANT_INLINE double ModalDeformation::mobility(const NodeWeights& at) const {
  const MatX<double> P = modes_at(at);
  return symmetric_eigenvalues(P * P.transpose()).maxCoeff();
}

}  // namespace pliant
