// A hinge: two points coincide, and the directions of two axes coincide.
//   C = (x_0 - y_0, size (theta / sin theta) (a . b_2, a . b_3)),   cos theta = a . b_1
// Here x_0 and y_0 are the two points, a is the first axis of the frame at x_0, b_1, b_2 and b_3 are the axes
// of the frame at y_0, and theta is the angle between a and b_1.
#pragma once

#include <pliant/body/joints/joint_setting.h>
#include <pliant/body/material_frame.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

struct Hinge {
  static constexpr const char* name = "hinge";
  static constexpr const char* formula = "x_0 - x_1 = 0, the axis at x_0 is parallel to the axis at x_1";
  static constexpr JointKeys keys{JointKey::axis, JointKey::from_axis};
  static constexpr int rows = 5, first = MaterialFrame::points, second = MaterialFrame::points;
  static constexpr bool one_sided = false, framed = true;
  MaterialFrame from, to;
  double size = 1;  ///< factor from angles (rad) to lengths, m

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    Vec<T, rows> C;
    C.template head<3>() = a.x - b.x;
    C.template tail<2>() = axis_angle(Vec3<T>(a.axes.col(0)), b.axes) * T(size);
    return C;
  }

  /// Returns (theta / sin theta) (a . b_2, a . b_3) for a unit vector a and a frame b.
  template <class T>
  static Vec<T, 2> axis_angle(const Vec3<T>& a, const Mat3<T>& b) {
    Vec3<T> of_b = b.transpose() * a;
    // Near theta = pi, a . b_2 and a . b_3 give no direction: choose one, like rotation_vector().
    if (plain(of_b[0]) <= kHalfTurnCosine) of_b[1] += T(kHalfTurnOffset);
    of_b /= math::sqrt(T(of_b.dot(of_b)));
    const T factor = angle_over_sine(of_b[0], T(of_b[1] * of_b[1] + of_b[2] * of_b[2]));
    return {of_b[1] * factor, of_b[2] * factor};
  }
};

}  // namespace pliant
