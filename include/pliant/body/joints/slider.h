// A slider: a point on a line, without relative rotation.
//   C = ((b_2, b_3) . (x_0 - y_0), size times the rotation vector of b^T a)
// Here a and b are the frames at x_0 and y_0; the first axis of b is the direction of the line.
#pragma once

#include <pliant/body/joints/joint_setting.h>
#include <pliant/body/material_frame.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

struct Slider {
  static constexpr const char* name = "slider";
  static constexpr const char* formula =
      "(x_0 - x_1) x d = 0 with the direction d at x_1, and no relative rotation";
  static constexpr JointKeys keys{JointKey::axis, JointKey::rotation};
  static constexpr int rows = 5, first = MaterialFrame::points, second = MaterialFrame::points;
  static constexpr bool one_sided = false, framed = true;
  MaterialFrame from, to;
  double size = 1;  ///< factor from angles (rad) to lengths, m

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    Vec<T, rows> C;
    C.template head<2>() = b.axes.template rightCols<2>().transpose() * (a.x - b.x);
    C.template tail<3>() = rotation_vector(Mat3<T>(b.axes.transpose() * a.axes)) * T(size);
    return C;
  }
};

}  // namespace pliant
