// Evaluation of prescribed motions.
#include <pliant/part/prescribed_motion.h>

#include <algorithm>
#include <cmath>

namespace pliant {

MovingFrame PrescribedMotion::at(double t) const {
  const Vec3<Taylor2<double>> x = position.at(t);
  const Taylor2<double> phi = angle.at(t);
  MovingFrame frame;
  for (int i = 0; i < 3; ++i) {
    frame.c[i] = x[i].v;
    frame.c_dot[i] = x[i].d;
    frame.c_ddot[i] = x[i].dd;
  }
  frame.R = orientation_at(t).toRotationMatrix();
  frame.omega = phi.d * axis;
  frame.omega_dot = phi.dd * axis;
  return frame;
}

TimeVector::MeanRate PrescribedMotion::over(double t, double h, double reach) const {
  TimeVector::MeanRate mean = position.over(t, h);
  double angular_speed = 0;
  for (const double share : kMoments)
    angular_speed = std::max(angular_speed, std::abs(angle.at(t + share * h).d));
  mean.max_deviation += reach * angular_speed;
  return mean;
}

Eigen::Quaterniond PrescribedMotion::orientation_at(double t) const {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle.value(t), axis)) * orientation;
}

}  // namespace pliant
