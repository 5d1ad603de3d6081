// The material points on which a coordinate of a joint, or its limit, depends: on each side, the four points
// that define a frame (material_frame.h; IsFramed in joints/joint.h).
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
