// The rates q_dot of the coordinates q of Eq. (10): theta_dot = 1/2 theta o (0, omega) for the quaternions,
// where o is the product of quaternions. The rates of all other coordinates are their velocities.
#pragma once

#include <pliant/body/dynamics.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE void Dynamics::coordinate_rates(const VecX<double>& q, const VecX<double>& v,
                                              VecX<double>& q_dot) const {
  q_dot.resize(q.size());
  for (const PartModel& m : model_->parts()) {
    if (m.q0 < 0) continue;
    q_dot.segment<3>(m.q0) = v.segment<3>(m.v0);
    const auto theta = q.segment<4>(m.q0 + 3);
    const auto omega = v.segment<3>(m.v0 + 3);
    auto rate = q_dot.segment<4>(m.q0 + 3);
    rate[0] = -0.5 * (theta[1] * omega[0] + theta[2] * omega[1] + theta[3] * omega[2]);
    rate[1] = 0.5 * (theta[0] * omega[0] + theta[2] * omega[2] - theta[3] * omega[1]);
    rate[2] = 0.5 * (theta[0] * omega[1] + theta[3] * omega[0] - theta[1] * omega[2]);
    rate[3] = 0.5 * (theta[0] * omega[2] + theta[1] * omega[1] - theta[2] * omega[0]);
    q_dot.segment(m.q0 + 7, m.n_s + m.n_d()) = v.segment(m.v0 + 6, m.n_s + m.n_d());
  }
}

}  // namespace pliant
