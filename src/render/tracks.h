// The tracks of a picture in one vertex buffer. Points that are less than one sample from the previous kept
// point are left out. The last point of a track, points behind the near plane and the first point after them
// are always kept. A track of one point is drawn as a dot.
#pragma once

#include <vector>

#include <pliant/render/picture.h>

#include "frame_block.h"
#include "render/gl/gl_objects.h"

namespace pliant {

class TrackBatch {
 public:
  struct Range {
    int first = 0;     ///< index of the first point
    int segments = 0;  ///< number of consecutive pairs of points
  };

  explicit TrackBatch(const gl::Functions& gl) : gl_(gl), array_(gl), points_(gl) {}

  /// Sends the tracks of a frame to the buffer. Throws std::invalid_argument, which names the track, if a
  /// track is not finite, is too far away or has a width out of range.
  void update(const Picture& picture, const FrameBlock& frame);

  const std::vector<Range>& ranges() const { return ranges_; }  ///< one range for each track
  /// Binds the array: attribute 0 is the start of a segment and attribute 1 its end, with one instance for
  /// each segment.
  void bind(const Range& range) const;

 private:
  const gl::Functions& gl_;
  gl::VertexArray array_;
  gl::Buffer points_;
  std::vector<float> scratch_;
  std::vector<Range> ranges_;
};

}  // namespace pliant
