// A motion that is prescribed: where a frame is at any time, and how it moves.
#pragma once

#include <Eigen/Geometry>

#include <pliant/math/time_function.h>

namespace pliant {

/// A frame that moves, at one time; all in the world.
struct MovingFrame {
  Vec3<double> c, c_dot, c_ddot;  ///< of its origin: m, m/s, m/s^2
  Mat3<double> R;                 ///< body to world
  Vec3<double> omega, omega_dot;  ///< rad/s, rad/s^2

  /// Of a point of the frame at c + r.
  Vec3<double> velocity(const Vec3<double>& r) const { return c_dot + omega.cross(r); }
  Vec3<double> acceleration(const Vec3<double>& r) const {
    return c_ddot + omega_dot.cross(r) + omega.cross(omega.cross(r));
  }
};

struct PrescribedMotion {
  TimeVector position;                                              ///< of the frame's origin, m, world
  Vec3<double> axis = {0, 0, 1};                                    ///< of length 1, world
  TimeFunction angle = 0;                                           ///< rad, right-handed about the axis
  Eigen::Quaterniond orientation = Eigen::Quaterniond(1, 0, 0, 0);  ///< where the angle is 0, body to world

  MovingFrame at(double t) const;
  /// See TimeFunction.
  Kink first_kink(double after, double until) const {
    return position.first_kink(after, until).or_sooner(angle.first_kink(after, until));
  }
  Eigen::Quaterniond orientation_at(double t) const;

  /// Over h seconds, of its points as far away from its origin as `reach` (m): m/s.
  TimeVector::Passage over(double t, double h, double reach) const;
};

}  // namespace pliant
