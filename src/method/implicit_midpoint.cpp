#include <pliant/method/implicit_midpoint.h>

#include <algorithm>
#include <complex>

#include <pliant/body/advance.h>
#include <pliant/project/project.h>

#include "linear_growth.h"
#include "method/implicit/stage_solver.h"
#include "method/implicit/stiff_pushes.h"

namespace pliant {

namespace {
/// What may be left of the equations of a step, in sizes and radians: rounding.
constexpr double kExactly = 1e-13;
}  // namespace

ImplicitMidpoint::ImplicitMidpoint() = default;
ImplicitMidpoint::~ImplicitMidpoint() = default;

void ImplicitMidpoint::step(const Dynamics& dynamics, State& state, Workspace<double>& work,
                            StepCounters& counters) {
  const Model& model = dynamics.model();
  const double h = state.h, t = state.time();
  if (!solver_) {
    solver_ = std::make_unique<StageSolver>(model);
    exactly_ = std::make_unique<ErrorScale>(model, kExactly);
  }
  dynamics.accelerations(t, state.q, state.v, state, work);
  ++counters.evaluations;
  v_ = state.v;
  stop_inertialess(model, work, v_);
  dynamics.coordinate_rates(state.q, v_, q_dot_);
  q_ = state.q + 0.5 * h * q_dot_;
  v_ += 0.5 * h * work.v_dot;
  solver_->begin(dynamics, state, 0.5 * h, *exactly_);
  solver_->solve(t + 0.5 * h, state.q, state.v, q_, v_, work, counters);
  state.q = 2 * q_ - state.q;
  state.v = 2 * v_ - state.v;
  state.work += h * work.power;
  end_motion(dynamics, t + h, state, work);
  const StiffPushes pushes(dynamics, t + h, 0.5 * h, state, work);
  project(dynamics, t + h, state, work, counters);
}

double ImplicitMidpoint::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  return linear_growth(K, D, h,
                       [](const std::complex<double>& z) { return (1. + 0.5 * z) / (1. - 0.5 * z); });
}

}  // namespace pliant
