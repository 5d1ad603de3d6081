// The view and the scale of values of a run, computed from the whole motion, and the tracks of each picture.
#include <pliant/render/film.h>

#include <algorithm>
#include <iterator>
#include <stdexcept>

#include <pliant/io/format/png.h>
#include <pliant/io/run/run_files.h>

namespace pliant {

Film::Film(const Scene& scene, const Model& model, const Recording& recording)
    : scene_(&scene), recording_(&recording), shown_(scene, model) {
  if (recording.rows() == 0) throw std::out_of_range("cannot draw the run: the recording has no state");
  tracks_ = track_lines(scene.tracks, model, recording);
  choose_view();
  choose_scale();
}

void Film::choose_view() {
  Eigen::AlignedBox3d bodies;
  for (std::int64_t row = 0; row < recording_->rows(); ++row)
    bodies.extend(shown_.bounds(recording_->state(row)));
  Eigen::AlignedBox3d all = bodies;
  for (const TrackLine& track : tracks_)
    for (const Eigen::Vector3d& x : track.points()) all.extend(x);
  for (std::int64_t row = 0; row < recording_->rows(); ++row)
    shown_.extend_to_anchors(recording_->time(row), bodies, all);
  shown_.set_view(bodies, all, static_cast<double>(scene_->width) / scene_->height);
}

void Film::choose_scale() {
  if (!scene_->coloring) return;
  std::optional<double> highest;
  // If the scene gives the range, one state is enough to find out whether any part has values.
  const std::int64_t rows = scene_->coloring->range ? 1 : recording_->rows();
  for (std::int64_t row = 0; row < rows; ++row) {
    const std::optional<double> here = shown_.meshes().high_value(recording_->state(row));
    if (here) highest = std::max(highest.value_or(0), *here);
  }
  if (highest) shown_.set_scale(*highest);
}

const Picture& Film::at(double time) {
  const State state = recording_->at(time);
  shown_.set(state);
  std::vector<Picture::Track> tracks;
  for (const TrackLine& track : tracks_) tracks.push_back(track.until(state));
  Picture& picture = shown_.picture();
  picture.tracks.insert(picture.tracks.begin(), std::make_move_iterator(tracks.begin()),
                        std::make_move_iterator(tracks.end()));
  return picture;
}

void render_frames(const std::filesystem::path& folder, const FilmSource& source, double frame_rate,
                   const std::vector<std::int64_t>& frames, Progress& progress, GlBackend backend) {
  if (frames.empty()) return;
  Film film(source.scene, source.model, source.recording);
  Renderer renderer(source.scene.width, source.scene.height, backend);
  progress.begin("frames", static_cast<double>(frames.size()), "frames");
  double done = 0;
  for (const std::int64_t frame : frames) {
    write_png(renderer.draw(film.at(static_cast<double>(frame) / frame_rate)),
              folder / frame_name("frame", frame, "png"));
    progress.advance(++done);
  }
  progress.end();
}

}  // namespace pliant
