// Bodies of free_stages.h.
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/method/free_stages.h>

#include <algorithm>

#include <pliant/math/index.h>

namespace pliant {

PLIANT_INLINE void FreeStages::prepare(const Model& model, const ButcherTableau& of, double h) {
  if (model_ != &model || of_ != &of) {
    model_ = &model;
    of_ = &of;
    h_ = 0;
    parts_.clear();
    for (const PartModel& m : model.parts())
      if (oscillates_freely(m))
        parts_.push_back({m.local->oscillators(),
                          m.q0 + 7 + m.n_s,
                          m.v0 + 6 + m.n_s,
                          MatX<double>::Zero(m.n_d(), of.stages + 1),
                          {},
                          {}});
  }
  if (h_ == h) return;
  h_ = h;
  for (OfPart& part : parts_) {
    part.from_start.clear();
    part.between.clear();
    for (int i = 0; i <= of.stages; ++i) {
      part.from_start.push_back(moves_over(*part.oscillators, node(i) * h));
      part.between.emplace_back(at(i));
      for (int j = 1; j < i; ++j)  // n_0 - n_0 is zero
        if (i == of.stages || weights(i)[j] != 0)
          part.between.back()[at(j)] = kicks_over(*part.oscillators, (node(i) - node(j)) * h);
    }
  }
}

PLIANT_INLINE void FreeStages::take(int stage, const VecX<double>& q, const VecX<double>& v,
                                    VecX<double>& v_dot) {
  for (OfPart& part : parts_) {
    const Eigen::Index n = part.n.rows();
    auto rates = v_dot.segment(part.v0, n);
    part.n.col(stage) = rates + part.oscillators->omega2.cwiseProduct(q.segment(part.q0, n)) +
                        part.oscillators->damping.cwiseProduct(v.segment(part.v0, n));
    rates.setZero();
  }
}

PLIANT_INLINE void FreeStages::still(VecX<double>& q_dot) const {
  for (const OfPart& part : parts_) q_dot.segment(part.q0, part.n.rows()).setZero();
}

PLIANT_INLINE void FreeStages::reuse_end_rates() {
  for (OfPart& part : parts_) part.n.col(0) = part.n.col(of_->stages);
}

PLIANT_INLINE void FreeStages::move(int stage, const VecX<double>& q_start, const VecX<double>& v_start,
                                    VecX<double>& q, VecX<double>& v) const {
  for (const OfPart& part : parts_) {
    const OscillatorMoves& whole = part.from_start[at(stage)];
    for (Eigen::Index k = 0; k < part.n.rows(); ++k) {
      const double q_0 = q_start[part.q0 + k], v_0 = v_start[part.v0 + k], n_0 = part.n(k, 0);
      q[part.q0 + k] = whole.qq[k] * q_0 + whole.qv[k] * v_0 + whole.qn[k] * n_0;
      v[part.v0 + k] = whole.vq[k] * q_0 + whole.vv[k] * v_0 + whole.qv[k] * n_0;
    }
    for (int j = 1; j < stage; ++j)
      if (const double weight = h_ * weights(stage)[j]; weight != 0)
        add_kicks(part, part.between[at(stage)][at(j)], j, weight, q, v);
  }
}

PLIANT_INLINE void FreeStages::weigh(const double* weights, int count, VecX<double>& q,
                                     VecX<double>& v) const {
  for (const OfPart& part : parts_) {
    const Eigen::Index n = part.n.rows();
    q.segment(part.q0, n).setZero();
    v.segment(part.v0, n).setZero();
    for (int j = 1; j < std::min(count, of_->stages); ++j)
      add_kicks(part, part.between.back()[at(j)], j, h_ * weights[j], q, v);
    if (count > of_->stages)  // at the end
      v.segment(part.v0, n) += h_ * weights[of_->stages] * (part.n.col(of_->stages) - part.n.col(0));
  }
}

PLIANT_INLINE void FreeStages::add_kicks(const OfPart& part, const OscillatorKicks& kicks, int stage,
                                         double weight, VecX<double>& q, VecX<double>& v) {
  for (Eigen::Index k = 0; k < part.n.rows(); ++k) {
    const double change = weight * (part.n(k, stage) - part.n(k, 0));
    q[part.q0 + k] += kicks.qv[k] * change;
    v[part.v0 + k] += kicks.vv[k] * change;
  }
}

}  // namespace pliant
