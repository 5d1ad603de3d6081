#include <pliant/integrate/free_oscillation.h>

#include <cmath>

#include <pliant/math/functions.h>

namespace pliant {

namespace {

/// c and s of exp(A h) = [c + g s, s; -omega^2 s, c - g s] for g = D/2: of a damped oscillation, or of a
/// decay that does not swing.
struct Swing {
  double c, s;
};
Swing swing(double omega2, double g, double h) {
  const double squared = omega2 - g * g;
  if (squared > 0) {
    const double kappa = std::sqrt(squared), fade = math::exp(-g * h);
    const math::SinCos<double> of = math::sin_cos(kappa * h);
    return {fade * of.cos, fade * of.sin / kappa};
  }
  // Two decays, of rates g - k and g + k.
  const double k = std::sqrt(-squared), slow = g + k > 0 ? omega2 / (g + k) : 0;
  const double fade = math::exp(-slow * h), faster = -std::expm1(-2 * k * h);
  return {fade * (1 - 0.5 * faster), k * h > 0 ? fade * faster / (2 * k) : fade * h};
}

}  // namespace

bool oscillates_freely(const PartModel& part) {
  return part.local != nullptr && part.local->oscillators() != nullptr && part.shared.empty();
}

void FreeOscillation::prepare(const Model& model, double h) {
  if (model_ == &model && h_ == h) return;
  model_ = &model;
  h_ = h;
  parts_.clear();
  for (const PartModel& m : model.parts()) {
    if (!oscillates_freely(m)) continue;
    const Oscillators& all = *m.local->oscillators();
    OfPart part{&all, m.q0 + 7 + m.n_s, m.v0 + 6 + m.n_s, {}, {}, {}, {}};
    const Eigen::Index n = all.omega2.size();
    for (VecX<double>* numbers : {&part.qq, &part.qv, &part.vq, &part.vv}) numbers->resize(n);
    for (Eigen::Index j = 0; j < n; ++j) {
      const double g = 0.5 * all.damping[j];
      const Swing of = swing(all.omega2[j], g, h);
      part.qq[j] = of.c + g * of.s;
      part.qv[j] = of.s;
      part.vq[j] = -all.omega2[j] * of.s;
      part.vv[j] = of.c - g * of.s;
    }
    parts_.push_back(std::move(part));
  }
}

void FreeOscillation::move(VecX<double>& q, VecX<double>& v) const {
  for (const OfPart& part : parts_)
    for (Eigen::Index j = 0; j < part.qq.size(); ++j) {
      double &of_q = q[part.q0 + j], &of_v = v[part.v0 + j];
      const double before = of_q;
      of_q = part.qq[j] * before + part.qv[j] * of_v;
      of_v = part.vq[j] * before + part.vv[j] * of_v;
    }
}

void FreeOscillation::take_off(const VecX<double>& q, const VecX<double>& v, VecX<double>& v_dot) const {
  for (const OfPart& part : parts_) {
    const Eigen::Index n = part.qq.size();
    v_dot.segment(part.v0, n) += part.oscillators->omega2.cwiseProduct(q.segment(part.q0, n)) +
                                 part.oscillators->damping.cwiseProduct(v.segment(part.v0, n));
  }
}

void FreeOscillation::take_off(VecX<double>& q_dot) const {
  for (const OfPart& part : parts_) q_dot.segment(part.q0, part.qq.size()).setZero();
}

}  // namespace pliant
