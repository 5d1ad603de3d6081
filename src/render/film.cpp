#include <pliant/render/film.h>

#include <algorithm>

#include <pliant/io/png.h>
#include <pliant/io/run_files.h>

namespace pliant {
namespace {

const Eigen::Vector3f kSpringColor(0.25f, 0.27f, 0.3f);
constexpr float kSpringWidth = 1.5f, kAnchorWidth = 6;  // pixels
constexpr double kVertical = 1e-5;                      // sine of the angle between view and z

Eigen::Vector3f vector_of(const Color& color) {
  return {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])};
}

}  // namespace

Film::Film(const Scene& scene, const Model& model, const Recording& recording)
    : scene_(&scene), model_(&model), recording_(&recording), meshes_(scene, model) {
  if (recording.rows() == 0) throw std::out_of_range("the recording holds no state");
  lay_tracks();
  choose_view();
  if (scene.light.direction) picture_.lights.to_key = scene.light.direction->cast<float>();
  picture_.lights.shadows = scene.light.shadows;
}

void Film::lay_tracks() {
  tracks_.resize(scene_->tracks.size());
  if (tracks_.empty()) return;
  for (std::int64_t row = 0; row < recording_->rows(); ++row) {
    const State state = recording_->state(row);
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      const Point& point = scene_->tracks[i].point;
      tracks_[i].push_back(place(point, state));
    }
  }
}

Eigen::Vector3d Film::place(const Point& point, const State& state) const {
  return model_->world_point(state, point);
}

// What is drawn of springs and joints: a line between two points where it keeps them apart, dots where it
// holds on to the world.
std::vector<Film::Tie> Film::ties() const {
  std::vector<Tie> all;
  if (!scene_->show_springs) return all;
  for (const auto& spring : scene_->body.springs()) all.push_back({{&spring->a, &spring->b}, true, nullptr});
  for (const auto& joint : scene_->body.joints()) {
    const std::vector<Point>& points = joint->points();
    Tie tie{{&points.front()}, joint->rows() == 1 && points.size() == 2, joint.get()};
    if (joint->n_points() > joint->n_first())
      tie.ends.push_back(&points[static_cast<std::size_t>(joint->n_first())]);
    all.push_back(std::move(tie));
  }
  return all;
}

// Where springs and joints hold on to the world, as far as that is beside the bodies and not somewhere far
// away.
Eigen::AlignedBox3d Film::anchors(const Eigen::AlignedBox3d& bodies) const {
  Eigen::AlignedBox3d box;
  if (bodies.isEmpty()) return box;
  const double reach = bodies.diagonal().norm();
  const std::vector<Tie> all = ties();
  for (std::int64_t row = 0; row < recording_->rows(); ++row)
    for (const Tie& tie : all)
      for (const Point* end : tie.ends) {
        if (end->part != nullptr) continue;
        const Eigen::Vector3d x = end->world.value(recording_->time(row));
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

void Film::draw_ties(const State& state) {
  for (const Tie& tie : ties()) {
    if (tie.joint != nullptr && !tie.joint->acts_at(state.time())) continue;
    if (tie.line) {
      Picture::Track line;
      line.points = {place(*tie.ends[0], state), place(*tie.ends[1], state)};
      line.color = kSpringColor;
      line.width = kSpringWidth;
      picture_.tracks.push_back(line);
    }
    for (const Point* end : tie.ends) {
      if (end->part != nullptr) continue;
      Picture::Track dot;
      dot.points = {place(*end, state)};
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
    picture_.bodies.push_back({&named.mesh, vector_of(named.color)});
  picture_.tracks.clear();
  std::int64_t rows = 0;  // recorded before now
  while (rows < recording_->rows() && recording_->time(rows) < state.time()) ++rows;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const Point& point = scene_->tracks[i].point;
    Picture::Track track;
    track.points.assign(tracks_[i].begin(), tracks_[i].begin() + rows);
    track.points.push_back(place(point, state));
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
