// Function bodies of implicit_modes.h: the diagonal system of the modes, and the small dense system of
// v_r = (R^T c_dot, omega, q_s_dot).
#pragma once

#include <pliant/method/implicit/implicit_modes.h>

#include <pliant/math/header_only.h>
#include <pliant/part/local/modal_deformation.h>

namespace pliant {

PLIANT_INLINE ImplicitModes::ImplicitModes(const PartModel& part) : ImplicitPart(part) {
  const Eigen::Index n = part.local->n_d();
  P_.resize(3 * static_cast<Eigen::Index>(part.joint_points.size()), n);
  VecX<double> buffer;
  for (Eigen::Index j = 0; j < n; ++j) {
    const VecX<double> mode = VecX<double>::Unit(n, j);
    P_.col(j) = at_points(part.joint_points, part.local->at_nodes(mode.data(), buffer));
  }
}

PLIANT_INLINE int ImplicitModes::prepare(const PartWorkspace<double>& w, double c, double) {
  c_ = c;
  oscillators_ = part_->local->modal()->oscillators_at(w.local->law_factor);
  sigma_ = 1 + c * oscillators_.damping.array() + c * c * oscillators_.omega2.array();
  const Part& part = *part_->part;
  const Eigen::Index n_s = part_->n_s;
  MatX<double> S_r = w.local->H0;
  D_s_ = part.alpha() * S_r.bottomRightCorner(n_s, n_s) + part.beta() * part.K_s();
  S_r.bottomRightCorner(n_s, n_s) += c * D_s_ + c * c * part.K_s();
  for (int k = 0; k < n_r(); ++k)
    if (w.without_inertia(k)) S_r(k, k) += 1;
  S_r_inverse_ = S_r.inverse();
  return 0;
}

PLIANT_INLINE void ImplicitModes::filter(const VecX<double>& q_dot, const Mat3<double>& R,
                                         VecX<double>& v_dot) {
  const Eigen::Index n_s = part_->n_s, n = part_->n_d();
  const auto r_q = q_dot.segment(part_->q0 + 7 + n_s, n);
  auto k_v = v_dot.segment(part_->v0 + 6 + n_s, n);
  const VecX<double> x =
      -c_ * (oscillators_.omega2.cwiseProduct(r_q + c_ * k_v) + oscillators_.damping.cwiseProduct(k_v))
                .cwiseQuotient(sigma_);
  k_v += x;
  change_.tail(P_.rows()) = P_ * x;
  if (n_s == 0) return;
  const VecX<double> r_v_s = v_dot.segment(part_->v0 + 6, n_s), r_q_s = q_dot.segment(part_->q0 + 7, n_s);
  change_.head(n_r()) = S_r_inverse_.rightCols(n_s) *
                        (-c_ * D_s_ * r_v_s - part_->part->K_s() * (c_ * c_ * r_v_s + c_ * r_q_s));
  v_dot.segment<3>(part_->v0) += R * change_.head<3>();
  v_dot.segment(part_->v0 + 3, n_r() - 3) += change_.segment(3, n_r() - 3);
}

PLIANT_INLINE MatX<double> ImplicitModes::compliance() const {
  MatX<double> A = MatX<double>::Zero(change_.size(), change_.size());
  A.topLeftCorner(n_r(), n_r()) = S_r_inverse_;
  A.bottomRightCorner(P_.rows(), P_.rows()) = P_ * sigma_.cwiseInverse().asDiagonal() * P_.transpose();
  return A;
}

PLIANT_INLINE void ImplicitModes::push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_ddot) const {
  d_ddot += (P_.transpose() * g.tail(P_.rows())).cwiseQuotient(sigma_);
}

PLIANT_INLINE void ImplicitModes::respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const {
  on_frame = S_r_inverse_ * on_frame;
  on_d = on_d.cwiseQuotient(sigma_).eval();
}

}  // namespace pliant
