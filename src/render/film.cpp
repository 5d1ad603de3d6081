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
constexpr double kVertical = 1e-5;                      // sine of the angle between view and z
constexpr double kRounding = 1e-9;                      // strain, or displacement over size, that is none

Eigen::Vector3f vector_of(const Color& color) {
  return {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])};
}

}  // namespace

Film::Film(const Scene& scene, const Model& model, const Recording& recording)
    : scene_(&scene), model_(&model), recording_(&recording), meshes_(scene, model) {
  if (recording.rows() == 0) throw std::out_of_range("the recording holds no state");
  lay_tracks();
  lay_ties();
  choose_view();
  choose_scale();
  if (scene.light.direction) picture_.lights.to_key = scene.light.direction->cast<float>();
  picture_.lights.shadows = scene.light.shadows;
}

void Film::lay_tracks() {
  for (const Track& track : scene_->tracks) tracked_.emplace_back(*model_, track.point);
  tracks_.resize(tracked_.size());
  if (tracks_.empty()) return;
  for (std::int64_t row = 0; row < recording_->rows(); ++row) {
    const State state = recording_->state(row);
    for (std::size_t i = 0; i < tracks_.size(); ++i) tracks_[i].push_back(tracked_[i].at(state));
  }
}

// What is drawn of springs and joints: a line between two points where it keeps them apart, dots where it
// holds on to the world.
void Film::lay_ties() {
  if (!scene_->show_springs) return;
  for (const auto& spring : scene_->body.springs())
    ties_.push_back({{{*model_, spring->a}, {*model_, spring->b}}, true, nullptr});
  for (const auto& joint : scene_->body.joints()) {
    const std::vector<Point>& points = joint->points();
    Tie tie{{{*model_, points.front()}}, joint->rows() == 1 && points.size() == 2, joint.get()};
    if (joint->n_points() > joint->n_first())
      tie.ends.emplace_back(*model_, points[static_cast<std::size_t>(joint->n_first())]);
    ties_.push_back(std::move(tie));
  }
}

// Where springs and joints hold on to the world, as far as that is beside the bodies and not somewhere far
// away.
Eigen::AlignedBox3d Film::anchors(const Eigen::AlignedBox3d& bodies) const {
  Eigen::AlignedBox3d box;
  if (bodies.isEmpty()) return box;
  const double reach = bodies.diagonal().norm();
  for (std::int64_t row = 0; row < recording_->rows(); ++row)
    for (const Tie& tie : ties_)
      for (const PlacedPoint& end : tie.ends) {
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
  // Straight down or up the picture's top is y.
  const Eigen::Vector3d view = camera.target - camera.eye;
  if (camera.up.cross(view).norm() <= kVertical * view.norm()) camera.up = Eigen::Vector3d::UnitY();
}

void Film::choose_scale() {
  if (!scene_->coloring) return;
  const Coloring& coloring = *scene_->coloring;
  std::optional<double> highest;
  const std::int64_t rows =
      coloring.range ? 1 : recording_->rows();  // one tells whether any part is coloured
  for (std::int64_t row = 0; row < rows; ++row) {
    const std::optional<double> here = meshes_.high_value(recording_->state(row));
    if (here) highest = std::max(highest.value_or(0), *here);
  }
  if (!highest) return;
  double rounding = coloring.by == SurfaceQuantity::strain ? kRounding : 0;
  if (coloring.by == SurfaceQuantity::displacement)
    for (const auto& part : scene_->body.parts()) rounding = std::max(rounding, kRounding * part->size());
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

void Film::draw_ties(const State& state) {
  for (const Tie& tie : ties_) {
    if (tie.joint != nullptr && !tie.joint->acts_at(state.time())) continue;
    if (tie.line) {
      Picture::Track line;
      line.points = {tie.ends[0].at(state), tie.ends[1].at(state)};
      line.color = kSpringColor;
      line.width = kSpringWidth;
      picture_.tracks.push_back(line);
    }
    for (const PlacedPoint& end : tie.ends) {
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
  std::int64_t rows = 0;  // recorded before now
  while (rows < recording_->rows() && recording_->time(rows) < state.time()) ++rows;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    Picture::Track track;
    track.points.assign(tracks_[i].begin(), tracks_[i].begin() + rows);
    track.points.push_back(tracked_[i].at(state));
    track.color = vector_of(scene_->tracks[i].color);
    picture_.tracks.push_back(std::move(track));
  }
  draw_ties(state);
  return picture_;
}

void render_frames(const std::filesystem::path& folder, const Scene& scene, const Model& model,
                   const Recording& recording, double frame_rate, const std::vector<std::int64_t>& frames,
                   Progress& progress, GlBackend backend) {
  if (frames.empty()) return;
  Film film(scene, model, recording);
  Renderer renderer(scene.width, scene.height, backend);
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
