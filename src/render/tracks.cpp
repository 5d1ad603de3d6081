// Thins out tracks, because a long run records more points than a picture has pixels. A point is kept if it
// is at least one sample away from the previous kept point. The ends of a track are always kept, and so are
// points behind the near plane and the first point after them.
#include "tracks.h"

#include <stdexcept>
#include <string>

namespace pliant {
namespace {

constexpr double kMaxTrackDistance = 1e15;  // metres
constexpr float kMaxTrackWidth = 1000;      // pixels

}  // namespace

void TrackBatch::update(const Picture& picture, const FrameBlock& frame) {
  scratch_.clear();
  ranges_.clear();
  for (std::size_t i = 0; i < picture.tracks.size(); ++i) {
    const Picture::Track& track = picture.tracks[i];
    const std::string name = "picture: track " + std::to_string(i);
    if (!(track.width > 0 && track.width <= kMaxTrackWidth))
      throw std::invalid_argument(name + " must have a width in (0, 1000] pixels, not " +
                                  std::to_string(track.width));
    Range range{static_cast<int>(scratch_.size() / 3), 0};
    Eigen::Vector2f last_seen = Eigen::Vector2f::Zero();
    bool last_visible = false;
    int kept = 0;
    for (std::size_t k = 0; k < track.points.size(); ++k) {
      const Eigen::Vector3d p = track.points[k] - picture.camera.target;
      if (!p.allFinite() || p.cwiseAbs().maxCoeff() > kMaxTrackDistance)
        throw std::invalid_argument(name + " is not finite or farther than 1e15 m from the target");
      const Eigen::Vector3f single = p.cast<float>();
      const Eigen::Vector4f clip = frame.view_projection * single.homogeneous();
      const bool visible = clip[3] > frame.eye[3];
      Eigen::Vector2f seen = Eigen::Vector2f::Zero();
      if (visible) seen = clip.head<2>().cwiseProduct(frame.viewport.head<2>()) / (2 * clip[3]);
      const bool ends = k == 0 || k + 1 == track.points.size();
      if (!ends && visible && last_visible && (seen - last_seen).squaredNorm() < 1) continue;
      scratch_.insert(scratch_.end(), {single[0], single[1], single[2]});
      if (track.points.size() == 1)
        scratch_.insert(scratch_.end(), {single[0], single[1], single[2]}), ++kept;
      ++kept;
      last_seen = seen;
      last_visible = visible;
    }
    range.segments = kept > 1 ? kept - 1 : 0;
    ranges_.push_back(range);
  }
  gl_.bind_buffer(gl::kArrayBuffer, points_.name());
  gl_.buffer_data(gl::kArrayBuffer, static_cast<std::ptrdiff_t>(scratch_.size() * sizeof(float)),
                  scratch_.data(), gl::kStreamDraw);
}

void TrackBatch::bind(const Range& range) const {
  gl_.bind_vertex_array(array_.name());
  gl_.bind_buffer(gl::kArrayBuffer, points_.name());
  for (gl::Uint end = 0; end < 2; ++end) {
    const std::size_t offset = (static_cast<std::size_t>(range.first) + end) * 3 * sizeof(float);
    gl_.vertex_attrib_pointer(end, 3, gl::kFloat, 0, 3 * sizeof(float),
                              reinterpret_cast<const void*>(offset));
    gl_.vertex_attrib_divisor(end, 1);
    gl_.enable_vertex_attrib_array(end);
  }
}

}  // namespace pliant
