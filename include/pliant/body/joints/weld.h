// A weld: two frames coincide.
//   C = (x_0 - y_0, size times the rotation vector of b^T a)
// Here a and b are the frames at x_0 and y_0.
#pragma once

#include <pliant/body/joints/joint_setting.h>
#include <pliant/body/material_frame.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

struct Weld {
  static constexpr const char* name = "weld";
  static constexpr const char* formula = "x_0 - x_1 = 0, and no relative rotation";
  static constexpr JointKeys keys{JointKey::rotation};
  static constexpr int rows = 6, first = MaterialFrame::points, second = MaterialFrame::points;
  static constexpr bool one_sided = false, framed = true;
  MaterialFrame from, to;
  double size = 1;  ///< factor from angles (rad) to lengths, m

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    Vec<T, rows> C;
    C.template head<3>() = a.x - b.x;
    C.template tail<3>() = rotation_vector(Mat3<T>(b.axes.transpose() * a.axes)) * T(size);
    return C;
  }
};

}  // namespace pliant
