#include <pliant/integrate/linearly_implicit.h>

#include <cmath>

#include <Eigen/Eigenvalues>

#include <pliant/integrate/advance.h>
#include <pliant/integrate/settle.h>

#include "hold_rates.h"
#include "implicit_modes.h"
#include "implicit_nodes.h"

namespace pliant {

namespace {

const double kGamma = 1 - std::sqrt(0.5);

/// While it lives, pushes move stiff parts as they do over a step. What brings a part onto a string or a
/// limit would else move no more than the node that it pushes, and put energy without bound into its
/// elasticity.
class StepResponse {
 public:
  StepResponse(const Model& model, const std::vector<std::unique_ptr<ImplicitPart>>& soft,
               Workspace<double>& work)
      : work_(work) {
    for (std::size_t i = 0; i < soft.size(); ++i) {
      const PartModel& m = model.parts()[i];
      if (soft[i] == nullptr || (m.island < 0 && m.n_s == 0)) continue;
      PartWorkspace<double>& w = work.parts[i];
      w.local->response = soft[i].get();
      m.local->compliance(m.shared, *w.local);
      w.inertia.M = w.local->A_inverse;
    }
    for (const Island& island : model.islands())
      if (has_implicit(island, soft)) factor_joints<double>(model, island, work.parts, work.joints);
  }
  ~StepResponse() {
    for (PartWorkspace<double>& w : work_.parts)
      if (w.local) w.local->response = nullptr;
  }
  StepResponse(const StepResponse&) = delete;
  StepResponse& operator=(const StepResponse&) = delete;

 private:
  Workspace<double>& work_;
};

}  // namespace

LinearlyImplicit::LinearlyImplicit() = default;
LinearlyImplicit::~LinearlyImplicit() = default;

void LinearlyImplicit::take_soft(const Dynamics& dynamics, double t, double c, const Workspace<double>& work,
                                 StepCounters& counters) {
  const Model& model = dynamics.model();
  if (soft_.empty()) {
    soft_.resize(model.parts().size());
    for (std::size_t i = 0; i < soft_.size(); ++i) {
      const PartModel& m = model.parts()[i];
      if (m.local == nullptr) continue;
      if (m.local->oscillators() != nullptr)
        soft_[i] = std::make_unique<ImplicitModes>(m);
      else
        soft_[i] = std::make_unique<ImplicitNodes>(m, model.body().joint_solver.make_factor());
    }
  }
  for (std::size_t i = 0; i < soft_.size(); ++i)
    if (soft_[i] != nullptr) counters.factorisations += soft_[i]->prepare(work.parts[i], c, t);
}

void LinearlyImplicit::filter(const Model& model, const Workspace<double>& work, const VecX<double>& q_dot,
                              VecX<double>& v_dot) {
  bool any = false;
  for (std::size_t i = 0; i < soft_.size(); ++i) {
    if (soft_[i] == nullptr) continue;
    soft_[i]->filter(q_dot, work.parts[i].R, v_dot);
    any = true;
  }
  if (any) hold_rates(model, soft_, work, filtered_, v_dot);
}

void LinearlyImplicit::step(const Dynamics& dynamics, State& state, Workspace<double>& work,
                            StepCounters& counters) {
  const Model& model = dynamics.model();
  const double h = state.h, t = state.time(), c = kGamma * h;

  dynamics.accelerations(t, state.q, state.v, state, work);
  ++counters.evaluations;
  v_ = state.v;
  hold_inertialess(model, work, v_);
  take_soft(dynamics, t, c, work, counters);
  dynamics.coordinate_rates(state.q, v_, q_rate1_);
  v_rate1_ = work.v_dot;
  filter(model, work, q_rate1_, v_rate1_);
  dynamics.coordinate_rates(state.q, v_rate1_, q_dot_);
  q_rate1_ += c * q_dot_;
  Vec<double, kWorks> power = work.power;

  q_ = state.q + h * q_rate1_;
  v_ = state.v + h * v_rate1_;
  dynamics.accelerations(t + h, q_, v_, state, work, RankRule::keep);
  ++counters.evaluations;
  hold_inertialess(model, work, v_);
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
    note_error(scale()->norm(q_dot_, v_, state.v));
  }
  state.q += h * (1.5 * q_rate1_ + 0.5 * q_rate2_);
  state.v += h * (1.5 * v_rate1_ + 0.5 * v_rate2_);
  state.work += 0.5 * h * power;
  end_motion(dynamics, t + h, state, work);
  const StepResponse response(model, soft_, work);
  settle(dynamics, t + h, state, work, counters);
}

double LinearlyImplicit::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  // u = (x, v); A of what is explicit: x_dot = v alone.
  const Eigen::Index n = K.rows();
  const MatX<double> I = MatX<double>::Identity(2 * n, 2 * n);
  MatX<double> F = MatX<double>::Zero(2 * n, 2 * n), filter = I;
  F.topRightCorner(n, n).setIdentity();
  F.bottomLeftCorner(n, n) = -K;
  F.bottomRightCorner(n, n) = -D;
  filter.topRightCorner(n, n) = kGamma * h * MatX<double>::Identity(n, n);
  const MatX<double> k1 = filter * F, k2 = filter * (F * (I + h * k1) - 2 * k1);
  return (I + 1.5 * h * k1 + 0.5 * h * k2).eigenvalues().cwiseAbs().maxCoeff();
}

}  // namespace pliant
