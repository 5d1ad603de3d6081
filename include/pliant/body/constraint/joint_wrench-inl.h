// The action of a joint on its first side: the sum of the forces C_x^T lambda at the points of this side.
#pragma once

#include <array>

#include <pliant/body/dynamics.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE Wrench Dynamics::joint_wrench(double t, int joint, const Workspace<double>& work,
                                            const VecX<double>& lambda) const {
  const JointModel& m = model_->joints()[static_cast<std::size_t>(joint)];
  std::array<PointMotion<double>, kMaxJointPoints> motion;
  for (std::size_t k = 0; k < m.at.size(); ++k) {
    const PortRef& ref = m.at[k];
    const Vec3<double> x =
        ref.part < 0
            ? m.joint->points()[k].world.value(t)
            : work.parts[static_cast<std::size_t>(ref.part)].port_x[static_cast<std::size_t>(ref.port)];
    motion[k] = {x, Vec3<double>::Zero(), Vec3<double>::Zero()};
  }
  JointRows<double> rows;
  m.joint->evaluate(t, motion.data(), rows);
  Wrench sum{Vec3<double>::Zero(), Vec3<double>::Zero()};
  for (int k = 0; k < m.joint->n_first(); ++k) {
    const Vec3<double> force = rows.C_x.middleCols(3 * k, 3).transpose() * lambda.segment(m.row, m.rows);
    sum.force += force;
    sum.torque += (motion[static_cast<std::size_t>(k)].x - motion[0].x).cross(force);
  }
  return sum;
}

}  // namespace pliant
