#include <pliant/part/prescribed_motion.h>

#include <algorithm>

namespace pliant {

MovingFrame PrescribedMotion::at(double t) const {
  const Vec3<Taylor2<double>> x = position.at(t);
  const Taylor2<double> turn = angle.at(t);
  MovingFrame frame;
  for (int i = 0; i < 3; ++i) {
    frame.c[i] = x[i].v;
    frame.c_dot[i] = x[i].d;
    frame.c_ddot[i] = x[i].dd;
  }
  frame.R = orientation_at(t).toRotationMatrix();
  frame.omega = turn.d * axis;
  frame.omega_dot = turn.dd * axis;
  return frame;
}

PrescribedMotion::Mean PrescribedMotion::over(double t, double h, double reach) const {
  const MovingFrame now = at(t), then = at(t + h);
  const Vec3<double> c_dot = (then.c - now.c) / h;
  return {c_dot, reach * std::max(now.omega.norm(), then.omega.norm()) +
                     std::max((now.c_dot - c_dot).norm(), (then.c_dot - c_dot).norm())};
}

Eigen::Quaterniond PrescribedMotion::orientation_at(double t) const {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle.value(t), axis)) * orientation;
}

}  // namespace pliant
