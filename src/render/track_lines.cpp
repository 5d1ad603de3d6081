#include <pliant/render/track_lines.h>

#include <algorithm>
#include <cmath>

#include <pliant/io/recorded_step.h>
#include <pliant/render/state_picture.h>

namespace pliant {
namespace {

constexpr double kResolution = 1e-3;  // of a line, in diagonals of the box around it
constexpr int kMostPieces = 64;       // of a line between two recorded states
/// The bend of a line between two recorded states is measured at these fractions of the time between them.
constexpr double kProbes[] = {0.25, 0.5, 0.75};

using Positions = std::vector<Vec3<double>>;

Positions positions(const std::vector<TrackLine>& lines, const State& state) {
  Positions x;
  for (const TrackLine& line : lines) x.push_back(line.at(state));
  return x;
}

/// Returns the resolution of each line, m.
std::vector<double> resolutions(const std::vector<TrackLine>& lines, const Recording& recording) {
  std::vector<Eigen::AlignedBox3d> boxes(lines.size());
  for (std::int64_t row = 0; row < recording.rows(); ++row) {
    const Positions x = positions(lines, recording.state(row));
    for (std::size_t i = 0; i < lines.size(); ++i) boxes[i].extend(x[i]);
  }
  std::vector<double> resolution;
  for (const Eigen::AlignedBox3d& box : boxes) resolution.push_back(kResolution * box.diagonal().norm());
  return resolution;
}

/// Returns the number of pieces of the lines between two recorded states for which each piece is bent by at
/// most the resolution; at most kMostPieces. The bend of a piece is proportional to the square of its length.
/// low, high: positions at the two states.
int count_pieces(const std::vector<TrackLine>& lines, const std::vector<double>& resolution,
                 const RecordedStep& step, const Positions& low, const Positions& high) {
  double bends = 0;  // largest bend / resolution
  for (const double part : kProbes) {
    const Positions x = positions(lines, step.at(step.start() + part * (step.end() - step.start())));
    for (std::size_t i = 0; i < lines.size(); ++i)
      if (resolution[i] > 0)
        bends = std::max(bends, (x[i] - (1 - part) * low[i] - part * high[i]).norm() / resolution[i]);
  }
  return static_cast<int>(std::min<double>(std::ceil(std::sqrt(bends)), kMostPieces));
}

void append(std::vector<TrackLine>& lines, double t, const Positions& x,
            const std::vector<double>& resolution) {
  for (std::size_t i = 0; i < lines.size(); ++i) lines[i].append(t, x[i], resolution[i]);
}

/// Returns whether a point moves by more than the resolution of its line.
bool moves(const Positions& low, const Positions& high, const std::vector<double>& resolution) {
  for (std::size_t i = 0; i < low.size(); ++i)
    if ((high[i] - low[i]).norm() > resolution[i]) return true;
  return false;
}

}  // namespace

TrackLine::TrackLine(const Model& model, const Track& track)
    : tracked_(model, track.point), color_(picture_color(track.color)) {}

void TrackLine::append(double t, const Vec3<double>& x, double resolution) {
  if (!points_.empty() && (x - points_.back()).norm() <= resolution) return;
  times_.push_back(t);
  points_.push_back(x);
}

Picture::Track TrackLine::until(const State& state) const {
  Picture::Track line;
  const auto before = std::lower_bound(times_.begin(), times_.end(), state.time()) - times_.begin();
  line.points.assign(points_.begin(), points_.begin() + before);
  line.points.push_back(at(state));
  line.color = color_;
  return line;
}

std::vector<TrackLine> track_lines(const std::vector<Track>& tracks, const Model& model,
                                   const Recording& recording) {
  std::vector<TrackLine> lines;
  for (const Track& track : tracks) lines.emplace_back(model, track);
  if (lines.empty()) return lines;
  const std::vector<double> resolution = resolutions(lines, recording);
  State before;
  Positions low;
  for (std::int64_t row = 0; row < recording.rows(); ++row) {
    State state = recording.state(row);
    const Positions high = positions(lines, state);
    if (moves(low, high, resolution)) {
      const RecordedStep step(model, before, state);
      const int pieces = count_pieces(lines, resolution, step, low, high);
      for (int k = 1; k < pieces; ++k) {
        const double t = step.start() + k * (step.end() - step.start()) / pieces;
        append(lines, t, positions(lines, step.at(t)), resolution);
      }
    }
    append(lines, state.time(), high, resolution);
    before = std::move(state);
    low = high;
  }
  return lines;
}

}  // namespace pliant
