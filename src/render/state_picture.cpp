// Makes the picture of a state: its bodies, the lines of springs and joints, the camera, and the scale of
// colours.
#include <pliant/render/state_picture.h>

#include <algorithm>
#include <cmath>

#include <pliant/render/ticks.h>

namespace pliant {
namespace {

const Eigen::Vector3f kSpringColor(0.25f, 0.27f, 0.3f);
constexpr float kSpringWidth = 1.5f, kAnchorWidth = 6;  // pixels
constexpr double kVertical = 1e-5;  // a view is vertical if the sine of its angle to z is at most this
constexpr double kNoStrain = 1e-9;  // a smaller strain, or displacement / size of the part, is rounding error

}  // namespace

Eigen::Vector3f picture_color(const Color& color) {
  return {static_cast<float>(color[0]), static_cast<float>(color[1]), static_cast<float>(color[2])};
}

StatePicture::StatePicture(const Scene& scene, const Model& model)
    : scene_(&scene), model_(&model), meshes_(scene, model) {
  build_connectors();
  picture_.ground.shown = scene.ground.visible;
  if (scene.light.direction) picture_.lights.to_key = scene.light.direction->cast<float>();
  picture_.lights.shadows = scene.light.shadows;
}

// A spring is drawn as a line, and so is a joint with one equation between two points (a rod or a string).
// Ends of springs and of all joints that are attached to the world are drawn as dots.
void StatePicture::build_connectors() {
  if (!scene_->show_springs) return;
  for (const auto& spring : scene_->body.springs())
    connectors_.push_back({{{*model_, spring->a}, {*model_, spring->b}}, true, nullptr, spring.get()});
  for (const auto& joint : scene_->body.joints()) {
    const std::vector<Point>& points = joint->points();
    Connector connector{
        {{*model_, points.front()}}, joint->rows() == 1 && points.size() == 2, joint.get(), nullptr};
    if (joint->n_points() > joint->n_first())
      connector.ends.emplace_back(*model_, points[static_cast<std::size_t>(joint->n_first())]);
    connectors_.push_back(std::move(connector));
  }
}

void StatePicture::extend_to_anchors(double time, const Eigen::AlignedBox3d& bodies,
                                     Eigen::AlignedBox3d& box) const {
  if (bodies.isEmpty()) return;
  const double reach = bodies.diagonal().norm();
  for (const Connector& connector : connectors_)
    for (const PlacedPoint& end : connector.ends) {
      if (end.point().part != nullptr) continue;
      const Eigen::Vector3d x = end.point().world.value(time);
      if (bodies.exteriorDistance(x) <= reach) box.extend(x);
    }
}

void StatePicture::set_view(const Eigen::AlignedBox3d& bodies, const Eigen::AlignedBox3d& all,
                            double aspect) {
  if (scene_->ground.height)
    picture_.ground.height = *scene_->ground.height;
  else if (!bodies.isEmpty())
    picture_.ground.height = bodies.min().z() - 1e-3 * bodies.sizes().maxCoeff();

  const CameraSetting& asked = scene_->camera;
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

void StatePicture::set_scale(double highest) {
  const Coloring& coloring = *scene_->coloring;
  double rounding = coloring.by == SurfaceQuantity::strain ? kNoStrain : 0;
  if (coloring.by == SurfaceQuantity::displacement)
    for (const auto& part : scene_->body.parts()) rounding = std::max(rounding, kNoStrain * part->size());
  const QuantityInfo& quantity = quantity_info(coloring.by);
  const std::string unit = quantity.unit;
  picture_.scale = {unit == "1" ? quantity.name : quantity.name + (" (" + unit + ")"), 0, 1};
  if (coloring.range) {
    picture_.scale->low = coloring.range->front();
    picture_.scale->high = coloring.range->back();
  } else if (highest > rounding) {
    const double step = tick_step(highest);
    picture_.scale->high = std::ceil(highest / step) * step;
  }
}

void StatePicture::draw_connectors(const State& state) {
  for (const Connector& connector : connectors_) {
    if (!connector.acts_at(state.time())) continue;
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

void StatePicture::color_again() {
  meshes_ = FrameMeshes(*scene_, *model_);
  picture_.scale.reset();
}

void StatePicture::set(const State& state) {
  bodies_ = &meshes_.at(state);
  picture_.bodies.clear();
  for (const NamedMesh& named : *bodies_)
    picture_.bodies.push_back(
        {&named.mesh, picture_color(named.color), named.by_values ? &named.values : nullptr});
  picture_.tracks.clear();
  if (shows_connectors) draw_connectors(state);
}

}  // namespace pliant
