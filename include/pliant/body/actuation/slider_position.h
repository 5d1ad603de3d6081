// The position of a slider along its direction, C = b_1 . (x_0 - y_0), m. x_0 and y_0 are the points at the
// first and the second side of the slider; b_1 is the first axis of the frame at y_0.
#pragma once

#include <pliant/body/actuation/two_frames.h>

namespace pliant {

struct SliderPosition : TwoFrames {
  static constexpr const char* name = "slider position";
  static constexpr const char* formula = "b_1 . (x_0 - y_0)";
  static constexpr int rows = 1;
  static constexpr bool one_sided = false;

  template <class T>
  Vec<T, rows> C(const Framed<T>& a, const Framed<T>& b) const {
    return Vec<T, rows>(T(b.axes.col(0).dot(a.x - b.x)));
  }
};

}  // namespace pliant
