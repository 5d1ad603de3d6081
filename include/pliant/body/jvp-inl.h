// Directional derivatives of the accelerations: the stages of an evaluation with dual numbers.
#pragma once

#include <stdexcept>

#include <pliant/body/dynamics.h>
#include <pliant/body/stages/evaluation.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE VecX<double> Dynamics::jvp(double t, const VecX<double>& q, const VecX<double>& v,
                                         const StateDirection& along, const Workspace<double>& work,
                                         Workspace<Dual<1>>& dual_work) const {
  for (const PartModel& m : model_->parts())
    if (m.local != nullptr)
      throw std::logic_error(
          "jvp: part '" + m.part->name() +
          "' deforms locally; directional derivatives need parts without local deformation");
  using D = Dual<1>;
  auto dual = [](const VecX<double>& x, const VecX<double>& dx) {
    VecX<D> r(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      r[i] = D(x[i]);
      r[i].d[0] = dx[i];
    }
    return r;
  };
  const VecX<D> dual_q = dual(q, along.q), dual_v = dual(v, along.v);
  evaluate<D>({*this, t, dual_q, dual_v, dual_work, nullptr, &work});
  VecX<double> d(dual_work.v_dot.size());
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = dual_work.v_dot[i].d[0];
  return d;
}

PLIANT_INLINE VecX<double> Dynamics::jvp(const State& state, const StateDirection& along) const {
  Workspace<double> work;
  Workspace<Dual<1>> dual_work;
  accelerations(state.time(), state.q, state.v, state, work);
  return jvp(state.time(), state.q, state.v, along, work, dual_work);
}

}  // namespace pliant
