// The tracks of a picture in one vertex buffer, without the points that a picture cannot tell apart.
#pragma once

#include <vector>

#include <pliant/render/picture.h>

#include "frame_block.h"
#include "render/gl/gl_objects.h"

namespace pliant {

class TrackBatch {
 public:
  struct Range {
    int first = 0;     ///< point
    int segments = 0;  ///< consecutive pairs of points from there on
  };

  explicit TrackBatch(const gl::Functions& gl) : gl_(gl), array_(gl), points_(gl) {}

  /// Throws std::invalid_argument naming the track that is not finite or has no sensible width.
  void update(const Picture& picture, const FrameBlock& frame);

  const std::vector<Range>& ranges() const { return ranges_; }  ///< one a track
  /// Attribute 0 is the start of a segment, 1 its end, one segment an instance.
  void bind(const Range& range) const;

 private:
  const gl::Functions& gl_;
  gl::VertexArray array_;
  gl::Buffer points_;
  std::vector<float> scratch_;
  std::vector<Range> ranges_;
};

}  // namespace pliant
