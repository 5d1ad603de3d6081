// The rotation of a ball joint: the rotation vector of b^T a, rad. a and b are frames at the two points; they
// coincide at time 0 with undeformed parts. Its first component is the twist about the axis b_1; the other
// two are the swing.
#pragma once

#include <pliant/body/material_frame.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

struct BallRotation {
  static constexpr const char* name = "ball rotation";
  static constexpr const char* formula = "rotation vector of b^T a";
  static constexpr int rows = 3, first = MaterialFrame::points, second = MaterialFrame::points;
  static constexpr bool one_sided = false, framed = true;
  MaterialFrame from, to;

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    return rotation_vector(Mat3<T>(b.axes.transpose() * a.axes));
  }
};

}  // namespace pliant
