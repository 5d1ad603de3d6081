// The states that a run records for its tracks, in addition to the states that it records for frames.
#pragma once

#include <vector>

#include <pliant/body/placed_point.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// Selects the steps after which a state is recorded for the tracks of a scene: a tracked point has then
/// moved by more than 2 % of the size of its part since the last recorded state. Therefore tracks are smooth
/// at any frame rate, and no states are recorded for points at rest.
class TrackSampling {
 public:
  /// The model must outlive the object. Points of the tracks must be on parts of the model.
  TrackSampling(const Model& model, const std::vector<Track>& tracks);

  /// Stores the positions of the points at a recorded state.
  void note(const State& state);
  /// Returns whether a state is to be recorded, because a point has moved since the last call of note().
  /// note() must have been called before.
  bool has_moved(const State& state) const;

 private:
  struct Sampled {
    PlacedPoint point;
    double longest;     // largest distance from `last` without a new recorded state, m
    Vec3<double> last;  // position at the last call of note(), m
  };
  std::vector<Sampled> points_;
};

}  // namespace pliant
