// The parts, tracks, connectors, camera, ground and scale of values of each picture of a run.
#include <pliant/render/film.h>

#include <algorithm>
#include <cmath>

#include <pliant/io/format/png.h>
#include <pliant/io/run/run_files.h>
#include <pliant/render/ticks.h>

namespace pliant {
namespace {

const Eigen::Vector3f kSpringColor(0.25f, 0.27f, 0.3f);
constexpr float kSpringWidth = 1.5f, kAnchorWidth = 6;  // pixels
constexpr double kVertical = 1e-5;  // a view is vertical if the sine of its angle to z is at most this
constexpr double kNoStrain = 1e-9;  // a smaller strain, or displacement / size of the part, is rounding error

Eigen::Vector3f vector_of(const Color& color) {
  return {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])};
}

}  // namespace

Film::Film(const Scene& scene, const Model& model, const Recording& recording)
    : scene_(&scene), model_(&model), recording_(&recording), meshes_(scene, model) {
  if (recording.rows() == 0) throw std::out_of_range("cannot draw the run: the recording has no state");
  build_tracks();
  build_connectors();
  choose_view();
  choose_scale();
  if (scene.light.direction) picture_.lights.to_key = scene.light.direction->cast<float>();
  picture_.lights.shadows = scene.light.shadows;
}

void Film::build_tracks() {
  for (const Track& track : scene_->tracks) tracked_.emplace_back(*model_, track.point);
  tracks_.resize(tracked_.size());
  if (tracks_.empty()) return;
  for (std::int64_t row = 0; row < recording_->rows(); ++row) {
    const State state = recording_->state(row);
    for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i].push_back(tracked_[i].at(state));
  }
}

// A spring is drawn as a line, and so is a joint with one equation between two points (a rod or a string).
// Ends of springs and of all joints that are attached to the world are drawn as dots.
void Film::build_connectors() {
  if (!scene_->show_springs) return;
  for (const auto& spring : scene_->body.springs())
    connectors_.push_back({{{*model_, spring->a}, {*model_, spring->b}}, true, nullptr});
  for (const auto& joint : scene_->body.joints()) {
    const std::vector<Point>& points = joint->points();
    Connector connector{{{*model_, points.front()}}, joint->rows() == 1 && points.size() == 2, joint.get()};
    if (joint->n_points() > joint->n_first())
      connector.ends.emplace_back(*model_, points[static_cast<std::size_t>(joint->n_first())]);
    connectors_.push_back(std::move(connector));
  }
}

// Returns a box around those ends of springs and joints that are attached to the world and are not farther
// from the box of the bodies than its diagonal.
Eigen::AlignedBox3d Film::anchors(const Eigen::AlignedBox3d& bodies) const {
  Eigen::AlignedBox3d box;
  if (bodies.isEmpty()) return box;
  const double reach = bodies.diagonal().norm();
  for (std::int64_t row = 0; row < recording_->rows(); ++row)
    for (const Connector& connector : connectors_)
      for (const PlacedPoint& end : connector.ends) {
        if (end.point().part != nullptr) continue;
        const Eigen::Vector3d x = end.point().world.value(recording_->time(row));
        if (bodies.exteriorDistance(x) <= reach) box.extend(x);
      }
  return box;
}

void Film::choose_view() {
  Eigen::AlignedBox3d bodies;
  for (std::int64_t row = 0; row < recording_->rows(); ++row)
    bodies.extend(meshes_.bounds(recording_->state(row)));
  picture_.ground.shown = scene_->ground.visible;
  if (scene_->ground.height)
    picture_.ground.height = *scene_->ground.height;
  else if (!bodies.isEmpty())
    picture_.ground.height = bodies.min().z() - 1e-3 * bodies.sizes().maxCoeff();

  Eigen::AlignedBox3d all = bodies;
  for (const auto& track : tracks_)
    for (const Eigen::Vector3d& x : track) all.extend(x);
  all.extend(anchors(bodies));
  const CameraSetting& asked = scene_->camera;
  const double aspect = static_cast<double>(scene_->width) / scene_->height;
  Camera& camera = picture_.camera;
  camera = automatic_camera(all, aspect, asked.field_of_view);
  if (asked.target) {
    camera.eye += *asked.target - camera.target;
    camera.target = *asked.target;
  }
  if (asked.eye) camera.eye = *asked.eye;
  // In a vertical view the y axis points to the top of the picture.
  const Eigen::Vector3d view = camera.target - camera.eye;
  if (camera.up.cross(view).norm() <= kVertical * view.norm()) camera.up = Eigen::Vector3d::UnitY();
}

void Film::choose_scale() {
  if (!scene_->coloring) return;
  const Coloring& coloring = *scene_->coloring;
  std::optional<double> highest;
  // If the scene gives the range, one state is enough to find out whether any part has values.
  const std::int64_t rows = coloring.range ? 1 : recording_->rows();
  for (std::int64_t row = 0; row < rows; ++row) {
    const std::optional<double> here = meshes_.high_value(recording_->state(row));
    if (here) highest = std::max(highest.value_or(0), *here);
  }
  if (!highest) return;
  double rounding = coloring.by == SurfaceQuantity::strain ? kNoStrain : 0;
  if (coloring.by == SurfaceQuantity::displacement)
    for (const auto& part : scene_->body.parts()) rounding = std::max(rounding, kNoStrain * part->size());
  const QuantityInfo& quantity = quantity_info(coloring.by);
  const std::string unit = quantity.unit;
  picture_.scale = {unit == "1" ? quantity.name : quantity.name + (" (" + unit + ")"), 0, 1};
  if (coloring.range) {
    picture_.scale->low = coloring.range->front();
    picture_.scale->high = coloring.range->back();
  } else if (*highest > rounding) {
    const double step = tick_step(*highest);
    picture_.scale->high = std::ceil(*highest / step) * step;
  }
}

void Film::draw_connectors(const State& state) {
  for (const Connector& connector : connectors_) {
    if (connector.joint != nullptr && !connector.joint->acts_at(state.time())) continue;
    if (connector.line) {
      Picture::Track line;
      line.points = {connector.ends[0].at(state), connector.ends[1].at(state)};
      line.color = kSpringColor;
      line.width = kSpringWidth;
      picture_.tracks.push_back(line);
    }
    for (const PlacedPoint& end : connector.ends) {
      if (end.point().part != nullptr) continue;
      Picture::Track dot;
      dot.points = {end.at(state)};
      dot.color = kSpringColor;
      dot.width = kAnchorWidth;
      picture_.tracks.push_back(dot);
    }
  }
}

const Picture& Film::at(double time) {
  const State state = recording_->at(time);
  picture_.bodies.clear();
  for (const NamedMesh& named : meshes_.at(state))
    picture_.bodies.push_back(
        {&named.mesh, vector_of(named.color), named.by_values ? &named.values : nullptr});
  picture_.tracks.clear();
  std::int64_t rows = 0;  // number of states recorded before this time
  while (rows < recording_->rows() && recording_->time(rows) < state.time()) ++rows;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Picture::Track track;
    track.points.assign(tracks_[i].begin(), tracks_[i].begin() + rows);
    track.points.push_back(tracked_[i].at(state));
    track.color = vector_of(scene_->tracks[i].color);
    picture_.tracks.push_back(std::move(track));
  }
  draw_connectors(state);
  return picture_;
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
