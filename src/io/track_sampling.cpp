#include <pliant/io/track_sampling.h>

#include <algorithm>

namespace pliant {
namespace {

// The largest movement of a point without a new recorded state, in sizes of the part.
constexpr double kLongest = 0.02;

}  // namespace

TrackSampling::TrackSampling(const Model& model, const std::vector<Track>& tracks) {
  for (const Track& track : tracks)
    points_.push_back({{model, track.point}, kLongest * track.point.part->size(), Vec3<double>::Zero()});
}

void TrackSampling::note(const State& state) {
  for (Sampled& sampled : points_) sampled.last = sampled.point.at(state);
}

bool TrackSampling::has_moved(const State& state) const {
  return std::any_of(points_.begin(), points_.end(), [&](const Sampled& sampled) {
    return (sampled.point.at(state) - sampled.last).norm() > sampled.longest;
  });
}

}  // namespace pliant
