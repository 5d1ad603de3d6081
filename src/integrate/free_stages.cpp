#include <pliant/integrate/free_stages.h>

#include <pliant/math/index.h>

namespace pliant {

void FreeStages::prepare(const Model& model, const ButcherTableau& of, double h) {
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

void FreeStages::take(int stage, const VecX<double>& q, const VecX<double>& v, VecX<double>& v_dot) {
  for (OfPart& part : parts_) {
    const Eigen::Index n = part.n.rows();
    auto rates = v_dot.segment(part.v0, n);
    part.n.col(stage) = rates + part.oscillators->omega2.cwiseProduct(q.segment(part.q0, n)) +
                        part.oscillators->damping.cwiseProduct(v.segment(part.v0, n));
    rates.setZero();
  }
}

void FreeStages::still(VecX<double>& q_dot) const {
  for (const OfPart& part : parts_) q_dot.segment(part.q0, part.n.rows()).setZero();
}

void FreeStages::begin_at_end() {
  for (OfPart& part : parts_) part.n.col(0) = part.n.col(of_->stages);
}

void FreeStages::move(int stage, const VecX<double>& q_start, const VecX<double>& v_start, VecX<double>& q,
                      VecX<double>& v) const {
  for (const OfPart& part : parts_) {
    const Eigen::Index n = part.n.rows();
    const VecX<double> q_0 = q_start.segment(part.q0, n), v_0 = v_start.segment(part.v0, n);
    auto q_now = q.segment(part.q0, n), v_now = v.segment(part.v0, n);
    const OscillatorMoves& whole = part.from_start[at(stage)];
    q_now = whole.qq.cwiseProduct(q_0) + whole.qv.cwiseProduct(v_0) + whole.qn.cwiseProduct(part.n.col(0));
    v_now = whole.vq.cwiseProduct(q_0) + whole.vv.cwiseProduct(v_0) + whole.qv.cwiseProduct(part.n.col(0));
    for (int j = 1; j < stage; ++j) {
      const double weight = h_ * weights(stage)[j];
      if (weight == 0) continue;
      const OscillatorKicks& kicks = part.between[at(stage)][at(j)];
      const VecX<double> change = weight * (part.n.col(j) - part.n.col(0));
      q_now += kicks.qv.cwiseProduct(change);
      v_now += kicks.vv.cwiseProduct(change);
    }
  }
}

void FreeStages::weigh(const double* weights, int count, VecX<double>& q, VecX<double>& v) const {
  for (const OfPart& part : parts_) {
    const Eigen::Index n = part.n.rows();
    auto q_sum = q.segment(part.q0, n), v_sum = v.segment(part.v0, n);
    q_sum.setZero();
    v_sum.setZero();
    for (int j = 1; j < count; ++j) {
      const VecX<double> change = h_ * weights[j] * (part.n.col(j) - part.n.col(0));
      if (j == of_->stages) {  // at the end
        v_sum += change;
        continue;
      }
      const OscillatorKicks& kicks = part.between.back()[at(j)];
      q_sum += kicks.qv.cwiseProduct(change);
      v_sum += kicks.vv.cwiseProduct(change);
    }
  }
}

}  // namespace pliant
