// Function bodies of free_stages.h: the stages of an exponential integrator for free oscillators.
#pragma once

#include <pliant/method/free_stages.h>

#include <algorithm>

#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

PLIANT_INLINE void FreeStages::prepare(const Model& model, const ButcherTableau& tableau, double h) {
  if (model_ != &model || tableau_ != &tableau) {
    model_ = &model;
    tableau_ = &tableau;
    h_ = 0;
    parts_.clear();
    for (const PartModel& m : model.parts())
      if (oscillates_freely(m))
        parts_.push_back({m.local->oscillators(),
                          m.q0 + 7 + m.n_s,
                          m.v0 + 6 + m.n_s,
                          MatX<double>::Zero(m.n_d(), tableau.stages + 1),
                          {},
                          {}});
  }
  if (h_ == h) return;
  h_ = h;
  for (PartStages& part : parts_) {
    part.from_start.clear();
    part.between.clear();
    for (int i = 0; i <= tableau.stages; ++i) {
      part.from_start.push_back(propagator(*part.oscillators, node(i) * h));
      part.between.emplace_back(at(i));
      for (int j = 1; j < i; ++j)  // n_0 - n_0 is zero
        if (i == tableau.stages || weights(i)[j] != 0)
          part.between.back()[at(j)] = velocity_response(*part.oscillators, (node(i) - node(j)) * h);
    }
  }
}

PLIANT_INLINE void FreeStages::store_loads(int stage, const VecX<double>& q, const VecX<double>& v,
                                           VecX<double>& v_dot) {
  for (PartStages& part : parts_) {
    const Eigen::Index n = part.n.rows();
    auto rates = v_dot.segment(part.v0, n);
    part.n.col(stage) = rates + part.oscillators->omega2.cwiseProduct(q.segment(part.q0, n)) +
                        part.oscillators->damping.cwiseProduct(v.segment(part.v0, n));
    rates.setZero();
  }
}

PLIANT_INLINE void FreeStages::clear_rates(VecX<double>& q_dot) const {
  for (const PartStages& part : parts_) q_dot.segment(part.q0, part.n.rows()).setZero();
}

PLIANT_INLINE void FreeStages::reuse_end_rates() {
  for (PartStages& part : parts_) part.n.col(0) = part.n.col(tableau_->stages);
}

PLIANT_INLINE void FreeStages::advance(int stage, const VecX<double>& q_start, const VecX<double>& v_start,
                                       VecX<double>& q, VecX<double>& v) const {
  for (const PartStages& part : parts_) {
    const OscillatorPropagator& exact = part.from_start[at(stage)];
    for (Eigen::Index k = 0; k < part.n.rows(); ++k) {
      const double q_0 = q_start[part.q0 + k], v_0 = v_start[part.v0 + k], n_0 = part.n(k, 0);
      q[part.q0 + k] = exact.qq[k] * q_0 + exact.qv[k] * v_0 + exact.qn[k] * n_0;
      v[part.v0 + k] = exact.vq[k] * q_0 + exact.vv[k] * v_0 + exact.qv[k] * n_0;
    }
    for (int j = 1; j < stage; ++j)
      if (const double weight = h_ * weights(stage)[j]; weight != 0)
        add_load_change(part, part.between[at(stage)][at(j)], j, weight, q, v);
  }
}

PLIANT_INLINE void FreeStages::estimate_error(const double* weights, int count, VecX<double>& q_error,
                                              VecX<double>& v_error) const {
  for (const PartStages& part : parts_) {
    const Eigen::Index n = part.n.rows();
    q_error.segment(part.q0, n).setZero();
    v_error.segment(part.v0, n).setZero();
    for (int j = 1; j < std::min(count, tableau_->stages); ++j)
      add_load_change(part, part.between.back()[at(j)], j, h_ * weights[j], q_error, v_error);
    if (count > tableau_->stages)  // the rates at the end of the step
      v_error.segment(part.v0, n) +=
          h_ * weights[tableau_->stages] * (part.n.col(tableau_->stages) - part.n.col(0));
  }
}

PLIANT_INLINE void FreeStages::add_load_change(const PartStages& part, const VelocityResponse& response,
                                               int stage, double weight, VecX<double>& q, VecX<double>& v) {
  for (Eigen::Index k = 0; k < part.n.rows(); ++k) {
    const double change = weight * (part.n(k, stage) - part.n(k, 0));
    q[part.q0 + k] += response.qv[k] * change;
    v[part.v0 + k] += response.vv[k] * change;
  }
}

}  // namespace pliant
