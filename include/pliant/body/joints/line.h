// A point on a straight line, which is fixed in the world or in a part.
//   C = (b_2, b_3) . (x_0 - x_1)
// Here b is the frame at x_1; its first axis is the direction of the line.
#pragma once

#include <pliant/body/joints/joint_setting.h>
#include <pliant/body/material_frame.h>

namespace pliant {

struct Line {
  static constexpr const char* name = "line";
  static constexpr const char* formula = "(x_0 - x_1) x d = 0 with the direction d at x_1";
  static constexpr JointKeys keys{JointKey::axis};
  static constexpr int rows = 2, first = 1, second = MaterialFrame::points;
  static constexpr bool one_sided = false, framed = true;
  MaterialFrame to;

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    return b.axes.template rightCols<2>().transpose() * (a.x - b.x);
  }
};

}  // namespace pliant
