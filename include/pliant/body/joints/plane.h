// A point in a plane, which is fixed in the world or in a part.
//   C = n . (x_0 - x_1)
// Here n is the first axis of the frame at x_1.
#pragma once

#include <pliant/body/joints/joint_setting.h>
#include <pliant/body/material_frame.h>

namespace pliant {

struct Plane {
  static constexpr const char* name = "plane";
  static constexpr const char* formula = "n . (x_0 - x_1) = 0 with the normal n at x_1";
  static constexpr JointKeys keys{JointKey::axis};
  static constexpr int rows = 1, first = 1, second = MaterialFrame::points;
  static constexpr bool one_sided = false, framed = true;
  MaterialFrame to;

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    Vec<T, rows> C;
    C[0] = b.axes.col(0).dot(a.x - b.x);
    return C;
  }
};

}  // namespace pliant
