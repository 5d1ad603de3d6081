// Function bodies of semi_implicit_euler.h. A step advances the velocities, applies impulses before the
// coordinates move, advances the coordinates and projects them.
#pragma once

#include <pliant/method/semi_implicit_euler.h>

#include <pliant/body/advance.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/math/header_only.h>
#include <pliant/method/carry_momenta.h>
#include <pliant/project/project.h>

namespace pliant {

namespace semi_implicit_euler {

inline constexpr double kC[] = {0}, kB[] = {1};
inline constexpr ButcherTableau kTableau{
    "semi_implicit_euler", 1, 1, nullptr, kB, kC, nullptr, nullptr, 0, false};

/// Stores v in `before` and adds h v_dot to v, in one pass over memory.
inline void advance_velocities(double h, const VecX<double>& v_dot, VecX<double>& v, VecX<double>& before) {
  before.resize(v.size());
  for (Eigen::Index i = 0; i < v.size(); ++i) {
    before[i] = v[i];
    v[i] += h * v_dot[i];
  }
}

}  // namespace semi_implicit_euler

PLIANT_INLINE void SemiImplicitEuler::step(StepContext& step) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  const double h = state.h;
  dynamics.rates(state.time(), state.q, state.v, state, work);
  ++step.counters.evaluations;
  free_.prepare(dynamics.model(), semi_implicit_euler::kTableau, h);
  free_.store_loads(0, state.q, state.v, work.v_dot);
  semi_implicit_euler::advance_velocities(h, work.v_dot, state.v, v_before_);
  carry_momenta(dynamics.model(), work, v_before_, h, state);
  state.work += h * work.power;
  zero_inertialess_velocities(dynamics.model(), work, state.v);
  pre_step_impulses(step, v_before_, pre_step_);
  for (const PartModel& m : dynamics.model().parts()) {
    if (m.q0 < 0) continue;
    if (oscillates_freely(m))
      advance_part(m, state.q, part_velocities(m, state.v), h);
    else
      advance_whole_part(m, state.q, state.v, h);
  }
  free_.advance(1, state.q, state.v, state.q, state.v);
  step.t = state.time() + h;
  project_frames(step);
  clamp_to_limits(dynamics.model(), state);
  project_joints(step);
}

PLIANT_INLINE double SemiImplicitEuler::growth(const MatX<double>& K, const MatX<double>& D, double h) const {
  // (x, v) -> (x + h v', v'),  v' = v - h (K x + D v)
  const Eigen::Index n = K.rows();
  const MatX<double> I = MatX<double>::Identity(n, n);
  MatX<double> A(2 * n, 2 * n);
  A << I - h * h * K, h * (I - h * D), -h * K, I - h * D;
  return spectral_radius(A);
}

}  // namespace pliant
