// The position of a slider along its direction, C = b_1 . (x_0 - y_0), m. b_1 is the first axis of the frame
// at y_0.
#pragma once

#include <pliant/body/material_frame.h>

namespace pliant {

struct SliderPosition {
  static constexpr const char* name = "slider position";
  static constexpr const char* formula = "b_1 . (x_0 - y_0)";
  static constexpr int rows = 1, first = MaterialFrame::points, second = MaterialFrame::points;
  static constexpr bool one_sided = false, framed = true;
  MaterialFrame from, to;

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    return Vec<T, rows>(T(b.axes.col(0).dot(a.x - b.x)));
  }
};

}  // namespace pliant
