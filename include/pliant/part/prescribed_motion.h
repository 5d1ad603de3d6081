// Prescribed motion: position and orientation of a frame as functions of time, with velocity and
// acceleration.
#pragma once

#include <Eigen/Geometry>

#include <pliant/math/time_function.h>

namespace pliant {

/// A moving frame at one time, in world coordinates.
struct MovingFrame {
  Vec3<double> c, c_dot, c_ddot;  ///< origin: position (m), velocity (m/s), acceleration (m/s^2)
  Mat3<double> R;                 ///< body to world
  Vec3<double> omega, omega_dot;  ///< angular velocity (rad/s) and acceleration (rad/s^2)

  /// Returns the velocity (m/s, world) of the point at c + r that is fixed in the frame.
  Vec3<double> velocity(const Vec3<double>& r) const { return c_dot + omega.cross(r); }
  /// Returns the acceleration (m/s^2, world) of the point at c + r that is fixed in the frame.
  Vec3<double> acceleration(const Vec3<double>& r) const {
    return c_ddot + omega_dot.cross(r) + omega.cross(omega.cross(r));
  }
};

/// A motion that consists of a path of the origin and a rotation about an axis of fixed direction.
struct PrescribedMotion {
  TimeVector position;                                              ///< of the origin of the frame, m, world
  Vec3<double> axis = {0, 0, 1};                                    ///< unit vector, world
  TimeFunction angle = 0;                                           ///< rad, right-handed about the axis
  Eigen::Quaterniond orientation = Eigen::Quaterniond(1, 0, 0, 0);  ///< body to world at angle 0

  /// Returns the frame at time t (s).
  MovingFrame at(double t) const;
  /// Returns the first kink of position or angle between two times, see TimeFunction::first_kink().
  Kink first_kink(double after, double until) const {
    return position.first_kink(after, until).or_sooner(angle.first_kink(after, until));
  }
  /// Returns the orientation at time t, body to world.
  Eigen::Quaterniond orientation_at(double t) const;

  /// Returns the mean velocity of the origin from t to t + h (s), and an estimate of the largest difference
  /// between this mean and the velocity of a point at most `reach` (m) away from the origin. Both are in m/s.
  /// The estimate uses samples at kMoments (math/time_function.h).
  TimeVector::MeanRate over(double t, double h, double reach) const;
};

}  // namespace pliant
