// The points of a coordinate of a joint or of its limit: a frame on each side (joints/joint.h, IsFramed).
#pragma once

#include <pliant/body/material_frame.h>

namespace pliant {

/// The base of formulas C(a, b) of the frames a at the first side and b at the second side.
struct TwoFrames {
  static constexpr int first = MaterialFrame::points, second = MaterialFrame::points;
  static constexpr bool framed = true;
  MaterialFrame from, to;  ///< the frames a and b
};

}  // namespace pliant
