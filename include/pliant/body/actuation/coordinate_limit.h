// Limits of the coordinates of joints: one-sided rows C >= 0. When a limit stops a motion, C_dot becomes
// -restitution C_dot.
//   hinge   C = size (half - sign (x - middle)),   x: the angle
//   slider  C = half - sign (x - middle),          x: the position
//   ball    C = size (max^2 - theta^2) / (2 max),  theta: the angle between the axes a_1 and b_1 (swing)
//   ball    C = size (half - sign (x - middle)),   x: the twist (ball_rotation.h)
// The range of x is [middle - half, middle + half]; sign is 1 for the upper end of the range and -1 for the
// lower end. For angles, x - middle is in (-pi, pi], so the range is at most one turn. max is
// LimitRange::half.
#pragma once

#include <cmath>

#include <pliant/body/actuation/ball_rotation.h>
#include <pliant/body/actuation/hinge_angle.h>
#include <pliant/body/actuation/two_frames.h>
#include <pliant/body/joints/hinge.h>

namespace pliant {

/// The numbers of a limit.
struct LimitRange {
  double middle = 0, half = 1;  ///< rad or m
  double sign = 1;
  double size = 1;         ///< factor from angles (rad) to lengths, m
  double restitution = 0;  ///< from 0 to 1
};

/// The base of the formulas of limits: one one-sided row.
struct LimitFormula : LimitRange, TwoFrames {
  static constexpr int rows = 1;
  static constexpr bool one_sided = true;
};

struct HingeLimit : LimitFormula {
  static constexpr const char* name = "hinge limit";
  static constexpr const char* formula = "size (half - sign (angle - middle)) >= 0";

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    const Vec3<T> in_b = b.axes.transpose() * a.axes.col(1);
    const double c = std::cos(middle), s = std::sin(middle);
    const T x = angle_of(T(in_b[1] * c + in_b[2] * s), T(in_b[2] * c - in_b[1] * s));
    return Vec<T, rows>(T((T(half) - x * sign) * size));
  }
};

struct SliderLimit : LimitFormula {
  static constexpr const char* name = "slider limit";
  static constexpr const char* formula = "half - sign (position - middle) >= 0";

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    const T x = b.axes.col(0).dot(a.x - b.x) - T(middle);
    return Vec<T, rows>(T(T(half) - x * sign));
  }
};

struct SwingLimit : LimitFormula {  // half: the largest swing, rad
  static constexpr const char* name = "swing limit";
  static constexpr const char* formula = "size (max^2 - swing^2) / (2 max) >= 0";

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    const Vec<T, 2> swing = Hinge::axis_angle(Vec3<T>(a.axes.col(0)), b.axes);
    return Vec<T, rows>(T((T(half * half) - swing.dot(swing)) * (size / (2 * half))));
  }
};

struct TwistLimit : LimitFormula {
  static constexpr const char* name = "twist limit";
  static constexpr const char* formula = "size (half - sign (twist - middle)) >= 0";

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    const Vec<T, 2> twist = twist_direction(a, b);
    const double c = std::cos(middle), s = std::sin(middle);
    const T x = angle_of(T(twist[0] * c + twist[1] * s), T(twist[1] * c - twist[0] * s));
    return Vec<T, rows>(T((T(half) - x * sign) * size));
  }
};

}  // namespace pliant
