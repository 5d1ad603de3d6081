// Function body of carry_momenta.h. In the body frame the angular momentum L of each part about its centre of
// mass obeys L_dot = torque - omega x L. The new L is L + h torque, rotated by -h omega. L and the torque
// have their values before the step; omega has its value after v <- v + h v_dot.
#pragma once

#include <pliant/method/carry_momenta.h>

#include <Eigen/Cholesky>

#include <pliant/math/header_only.h>
#include <pliant/math/rotation.h>

namespace pliant {

PLIANT_INLINE void carry_momenta(const Model& model, const Workspace<double>& work,
                                 const VecX<double>& v_before, double h, State& state) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.q0 < 0 || m.local != nullptr || work.without_inertia[i] != 0) continue;
    const Vec3<double> omega_before = v_before.segment<3>(m.v0 + 3), omega = state.v.segment<3>(m.v0 + 3);
    if (omega_before.isZero(0) && omega.isZero(0)) continue;
    const PartWorkspace<double>& w = work.parts[i];
    const MatX<double>& M = w.M();
    const Vec3<double> r = w.inertia.moment / w.inertia.mass;
    const Mat3<double> I = M.block<3, 3>(3, 3) + w.inertia.mass * skew(r) * skew(r);
    auto angular_momentum = [&](const VecX<double>& v) -> Vec3<double> {
      Vec3<double> L = I * v.segment<3>(m.v0 + 3);
      if (m.n_s == 0) return L;
      const auto rates = v.segment(m.v0 + 6, m.n_s);
      const Vec3<double> P = M.topRightCorner(3, m.n_s).lazyProduct(rates);
      return L + M.block(3, 6, 3, m.n_s).lazyProduct(rates) - r.cross(P);
    };
    const Vec3<double> L = angular_momentum(state.v);
    const Vec3<double> without_gyroscopic = L + h * omega_before.cross(angular_momentum(v_before));
    const Vec3<double> impulse = quaternion(-h * omega) * without_gyroscopic - L;
    const Vec3<double> change = w.rigid != nullptr
                                    ? Vec3<double>(w.rigid->rigid_mass->inverse.block<3, 3>(3, 3) * impulse)
                                    : Vec3<double>(I.ldlt().solve(impulse));
    const auto theta = state.q.segment<4>(m.q0 + 3);
    state.v.segment<3>(m.v0 + 3) += change;
    state.v.segment<3>(m.v0) -= rotation(theta[0], theta[1], theta[2], theta[3]) * change.cross(r);
  }
}

}  // namespace pliant
