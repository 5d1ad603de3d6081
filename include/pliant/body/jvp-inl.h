// Directional derivatives of the accelerations, by dual numbers.
#include <stdexcept>

#include <pliant/body/dynamics.h>

namespace pliant {

VecX<double> Dynamics::jvp(double t, const VecX<double>& q, const VecX<double>& v,
                           const StateDirection& along, const Workspace<double>& work,
                           Workspace<Dual<1>>& dual_work) const {
  for (const PartModel& m : model_->parts())
    if (m.local != nullptr)
      throw std::logic_error("no derivative of the accelerations of part '" + m.part->name() +
                             "', which deforms locally");
  using D = Dual<1>;
  auto dual = [](const VecX<double>& x, const VecX<double>& dx) {
    VecX<D> r(x.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      r[i] = D(x[i]);
      r[i].d[0] = dx[i];
    }
    return r;
  };
  evaluate<D>(t, dual(q, along.q), dual(v, along.v), nullptr, &work, false, dual_work);
  VecX<double> d(dual_work.v_dot.size());
  for (Eigen::Index i = 0; i < d.size(); ++i) d[i] = dual_work.v_dot[i].d[0];
  return d;
}

VecX<double> Dynamics::jvp(const State& state, const StateDirection& along) const {
  Workspace<double> work;
  Workspace<Dual<1>> dual_work;
  accelerations(state.time(), state.q, state.v, state, work);
  return jvp(state.time(), state.q, state.v, along, work, dual_work);
}

}  // namespace pliant
