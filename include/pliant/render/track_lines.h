// The lines behind the tracked points of a recorded motion.
#pragma once

#include <vector>

#include <pliant/body/placed_point.h>
#include <pliant/io/recording.h>
#include <pliant/render/picture.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// The line behind a tracked point, as points in the order of time. Points of the motion that are near the
/// point before them are left out.
class TrackLine {
 public:
  /// model: must outlive the line.
  TrackLine(const Model& model, const Track& track);

  /// Returns the position of the tracked point at a state, m, world.
  Vec3<double> at(const State& state) const { return tracked_.at(state); }
  /// Appends a point x (m, world) at a time t (s), if it is farther than `resolution` (m) from the last
  /// point.
  void append(double t, const Vec3<double>& x, double resolution);
  const std::vector<Vec3<double>>& points() const { return points_; }

  /// Returns the line up to a state: all points before it, and the position at the state.
  Picture::Track until(const State& state) const;

 private:
  PlacedPoint tracked_;
  Eigen::Vector3f color_;
  std::vector<double> times_;  // s
  std::vector<Vec3<double>> points_;
};

/// Returns the lines of all tracks. The resolution of a line is a thousandth of the diagonal of the box
/// around it, which is about a pixel if the line fills the picture. If the line between two recorded states
/// is bent by more than the resolution, the motion between them is interpolated (RecordedStep) and drawn in
/// up to 64 pieces. Throws RecordingMismatch.
std::vector<TrackLine> track_lines(const std::vector<Track>& tracks, const Model& model,
                                   const Recording& recording);

}  // namespace pliant
