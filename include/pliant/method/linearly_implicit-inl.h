// Function bodies of linearly_implicit.h: a step of ROS2, and a step of linearly implicit Euler that replaces
// the step of ROS2 where stiff parts touch something or where strings or limits stop them.
#pragma once

#include <pliant/method/linearly_implicit.h>

#include <algorithm>
#include <cmath>

#include <pliant/body/advance.h>
#include <pliant/body/speed_scale.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/math/header_only.h>
#include <pliant/method/implicit/implicit_modes.h>
#include <pliant/method/implicit/implicit_nodes.h>
#include <pliant/method/implicit/project_rates.h>
#include <pliant/project/project.h>

namespace pliant {

namespace linearly_implicit {

inline const double kGamma = 1 - std::sqrt(0.5);

/// Returns whether a string or a limit can stop a part that deforms locally.
inline bool can_be_stopped(const Model& model) {
  for (const PartModel& m : model.parts()) {
    if (m.local == nullptr || m.q0 < 0) continue;
    if (m.island >= 0 && !model.islands()[static_cast<std::size_t>(m.island)].strings.empty()) return true;
    for (const Range& range : m.limits)
      if (std::isfinite(range.min) || std::isfinite(range.max)) return true;
  }
  return false;
}

}  // namespace linearly_implicit

PLIANT_INLINE LinearlyImplicit::LinearlyImplicit() = default;
PLIANT_INLINE LinearlyImplicit::~LinearlyImplicit() = default;

PLIANT_INLINE void LinearlyImplicit::prepare_implicit_parts(StepContext& step, double c) {
  const Model& model = step.model();
  ImplicitParts& parts = implicit_parts();
  if (parts.empty()) {
    parts.resize(model.parts().size());
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const PartModel& m = model.parts()[i];
      if (m.local == nullptr) continue;
      if (m.local->oscillators() != nullptr)
        parts[i] = std::make_unique<ImplicitModes>(m);
      else
        parts[i] = std::make_unique<ImplicitNodes>(m, model.body().joint_solver.make_factor());
    }
  }
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i] != nullptr) step.counters.factorisations += parts[i]->prepare(step.work.parts[i], c, step.t);
}

PLIANT_INLINE void LinearlyImplicit::filter(const Model& model, const Workspace<double>& work,
                                            const VecX<double>& q_dot, VecX<double>& v_dot) {
  ImplicitParts& parts = implicit_parts();
  bool has_implicit_part = false;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] == nullptr) continue;
    parts[i]->filter(q_dot, work.parts[i].R, v_dot);
    has_implicit_part = true;
  }
  if (has_implicit_part) project_rates(model, parts, work, filtered_, v_dot);
}

PLIANT_INLINE void LinearlyImplicit::set_responses(const Model& model, bool on,
                                                   Workspace<double>& work) const {
  const ImplicitParts& parts = implicit_parts();
  for (std::size_t i = 0; i < parts.size(); ++i)
    if (parts[i] != nullptr && work.parts[i].local)
      work.parts[i].local->response = on ? parts[i].get() : nullptr;
  if (!on) return;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (parts[i] == nullptr || (m.island < 0 && m.n_s == 0)) continue;
    PartWorkspace<double>& w = work.parts[i];
    m.local->compliance(m.joint_points, *w.local);
    w.inertia.M = w.local->A_inverse;
  }
  for (const Island& island : model.islands())
    if (has_implicit(island, parts)) factor_joints<double>(model, island, work.parts, work.joints);
}

/// Sets closed_string_was_slack_ if, at this evaluation, a closed string of an island with an implicit part
/// does not pull. This string may still pull later in the step, and the evaluation cannot predict this pull.
PLIANT_INLINE void LinearlyImplicit::record_slack_strings(const Model& model, const State& state,
                                                          const Workspace<double>& work) {
  for (std::size_t i = 0; i < model.islands().size(); ++i) {
    const Island& island = model.islands()[i];
    if (!has_implicit(island, second_order_parts_)) continue;
    const std::vector<OneSidedRow>& pushed = work.joints.pushed[i];
    for (std::size_t k = 0; k < island.strings.size(); ++k)
      closed_string_was_slack_ =
          closed_string_was_slack_ ||
          (state.joints[static_cast<std::size_t>(island.strings[k])] == JointMode::closed &&
           std::none_of(pushed.begin(), pushed.end(), [&](const OneSidedRow& row) {
             return row.part < 0 && row.k == static_cast<int>(k);
           }));
  }
}

/// Returns whether the step must be repeated with first order: the mode of a string or limit of an implicit
/// part changed in the step, or a closed string did not pull. now: the state after the step.
PLIANT_INLINE bool LinearlyImplicit::needs_first_order(const Model& model, const State& now) const {
  if (closed_string_was_slack_) return true;
  for (const Island& island : model.islands())
    if (has_implicit(island, second_order_parts_))
      for (const int j : island.strings)
        if (now.joints[static_cast<std::size_t>(j)] != before_.joints[static_cast<std::size_t>(j)])
          return true;
  for (std::size_t i = 0; i < model.parts().size(); ++i)
    for (std::size_t k = 0; second_order_parts_[i] != nullptr && k < model.parts()[i].limits.size(); ++k) {
      const std::size_t at = static_cast<std::size_t>(model.parts()[i].limit0) + k;
      if (now.at_limit[at] != before_.at_limit[at]) return true;
    }
  return false;
}

PLIANT_INLINE void LinearlyImplicit::step(StepContext& step) {
  if (touching_) return advance_first_order(step);
  const bool may_stop = linearly_implicit::can_be_stopped(step.model());
  if (may_stop) before_ = step.state;
  const double start = step.t;
  closed_string_was_slack_ = false;
  advance_second_order(step);
  if (!may_stop || !needs_first_order(step.model(), step.state)) return;
  step.state = before_;
  step.t = start;
  advance_first_order(step);
}

PLIANT_INLINE void LinearlyImplicit::advance_first_order(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  const double h = state.h, t = state.time();
  first_order_ = true;
  dynamics.accelerations(t, state.q, state.v, state, work);
  ++step.counters.evaluations;
  zero_inertialess_velocities(dynamics.model(), work, state.v);
  prepare_implicit_parts(step, h);
  dynamics.coordinate_rates(state.q, state.v, q_rate1_);
  v_rate1_ = work.v_dot;
  filter(dynamics.model(), work, q_rate1_, v_rate1_);
  if (scale() != nullptr) {
    dynamics.coordinate_rates(state.q, v_rate1_, q_dot_);
    q_dot_ *= 0.5 * h * h;
    v_.setZero(state.v.size());
    record_error(scale()->norm(q_dot_, v_, state.v));
  }
  state.v += h * v_rate1_;
  dynamics.coordinate_rates(state.q, state.v, q_rate1_);
  state.q += h * q_rate1_;
  state.work += h * work.power;
  step.t = t + h;
  end_step(step);
}

PLIANT_INLINE void LinearlyImplicit::advance_second_order(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  const Model& model = dynamics.model();
  const double h = state.h, t = state.time(), c = linearly_implicit::kGamma * h;
  first_order_ = false;

  dynamics.accelerations(t, state.q, state.v, state, work);
  ++step.counters.evaluations;
  v_ = state.v;
  zero_inertialess_velocities(model, work, v_);
  prepare_implicit_parts(step, c);
  record_slack_strings(model, state, work);
  dynamics.coordinate_rates(state.q, v_, q_rate1_);
  v_rate1_ = work.v_dot;
  filter(model, work, q_rate1_, v_rate1_);
  dynamics.coordinate_rates(state.q, v_rate1_, q_dot_);
  q_rate1_ += c * q_dot_;
  Vec<double, kWorks> power = work.power;

  q_ = state.q + h * q_rate1_;
  v_ = state.v + h * v_rate1_;
  dynamics.accelerations(t + h, q_, v_, state, work, RankRule::keep);
  ++step.counters.evaluations;
  record_slack_strings(model, state, work);
  zero_inertialess_velocities(model, work, v_);
  power += work.power;
  dynamics.coordinate_rates(q_, v_, q_rate2_);
  q_rate2_ -= 2 * q_rate1_;
  v_rate2_ = work.v_dot - 2 * v_rate1_;
  filter(model, work, q_rate2_, v_rate2_);
  dynamics.coordinate_rates(state.q, v_rate2_, q_dot_);
  q_rate2_ += c * q_dot_;

  if (scale() != nullptr) {
    q_dot_ = 0.5 * h * (q_rate1_ + q_rate2_);
    v_ = 0.5 * h * (v_rate1_ + v_rate2_);
    // The errors of rates of implicit parts are multiplied by min(1, slow_rate() h), so that they measure
    // displacements in a step shorter than 1 / slow_rate(). The step damps oscillations that are too fast for
    // h instead of following them, and these oscillations also move the frames of their parts.
    for (std::size_t i = 0; i < second_order_parts_.size(); ++i) {
      const PartModel& m = model.parts()[i];
      if (second_order_parts_[i] != nullptr) v_.segment(m.v0, m.n_v()) *= std::min(1.0, slow_rate(model) * h);
    }
    record_error(scale()->norm(q_dot_, v_, state.v));
  }
  state.q += h * (1.5 * q_rate1_ + 0.5 * q_rate2_);
  state.v += h * (1.5 * v_rate1_ + 0.5 * v_rate2_);
  state.work += 0.5 * h * power;
  step.t = t + h;
  end_step(step);
}

/// Ends the motion and projects strings, limits and joints with the response of implicit parts over a step.
/// If parts responded by M^-1, the projection onto a string or limit would move only the pushed node, and
/// would add energy without bound.
PLIANT_INLINE void LinearlyImplicit::end_step(StepContext& step) {
  end_motion(step);
  const StepResponses responses(*this, step.model(), step.work);
  project(step);
}

PLIANT_INLINE double LinearlyImplicit::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  // u = (x, v). The forces of this test equation are explicit: A contains only x_dot = v.
  const Eigen::Index n = K.rows();
  const MatX<double> I = MatX<double>::Identity(2 * n, 2 * n);
  MatX<double> F = MatX<double>::Zero(2 * n, 2 * n), filter = I;
  F.topRightCorner(n, n).setIdentity();
  F.bottomLeftCorner(n, n) = -K;
  F.bottomRightCorner(n, n) = -D;
  filter.topRightCorner(n, n) = linearly_implicit::kGamma * h * MatX<double>::Identity(n, n);
  const MatX<double> k1 = filter * F, k2 = filter * (F * (I + h * k1) - 2 * k1);
  return spectral_radius(I + 1.5 * h * k1 + 0.5 * h * k2);
}

}  // namespace pliant
