#include <pliant/io/frame_meshes.h>

#include <algorithm>
#include <utility>

#include <pliant/collision/mesh/obstacle_mesh.h>

namespace pliant {

namespace {

/// Returns a rectangle with the width and height of a plane's appearance, centred at the origin and
/// perpendicular to `normal`.
ObstacleMesh rectangle(const PlaneLook& look, const Vec3<double>& normal) {
  constexpr double kLevel = 1e-9;
  const Vec3<double> level(-normal[1], normal[0], 0);  // perpendicular to z and to the normal
  const Vec3<double> along = level.norm() > kLevel ? level.normalized() : Vec3<double>(Vec3<double>::UnitX());
  const Vec3<double> x = 0.5 * look.width * along, y = 0.5 * look.height * normal.cross(along);
  Eigen::Matrix3Xd corners(3, 4);
  corners << -x - y, x - y, x + y, y - x;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 2, 2, 3;
  return {corners, triangles};
}

/// Returns the triangles of an obstacle, with one normal per triangle. An open mesh gets each triangle twice,
/// once for each side.
TriangleMesh faceted(const ObstacleMesh& obstacle) {
  const Eigen::Index n = obstacle.triangles().cols(), all = obstacle.closed() ? n : 2 * n;
  TriangleMesh mesh;
  mesh.x = obstacle.vertices();
  mesh.normals.resize(3, all);
  mesh.triangles.resize(3, all);
  mesh.corners.resize(3, all);
  for (Eigen::Index t = 0; t < all; ++t) {
    const bool front = t < n;
    mesh.triangles.col(t) = obstacle.triangles().col(front ? t : t - n);
    if (!front) std::swap(mesh.triangles(1, t), mesh.triangles(2, t));
    mesh.normals.col(t) = (front ? 1 : -1) * obstacle.normal(static_cast<int>(front ? t : t - n));
    mesh.corners.col(t).setConstant(static_cast<int>(t));
  }
  return mesh;
}

}  // namespace

FrameMeshes::FrameMeshes(const Scene& scene, const Model& model, Values values) : model_(&model) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const Appearance& look = scene.appearance.at(i);
    if (!look.visible) continue;
    const Part& part = *model.parts()[i].part;
    meshes_.push_back({part.name(), look.color, {}});
    Shown& shown = shown_.emplace_back();
    shown.part = i;
    shown.rigid = part.rigid();
    if (part.local() == nullptr)
      shown.surface.emplace(part, look.resolution);
    else
      shown.nodes = surface_nodes(part.local()->mesh());
    if (shown.rigid) shown.body = shown.surface->body_mesh(part, part.parameters().rest());
    if (!scene.coloring || values == Values::omitted) continue;
    const ParameterValues<double> rest = part.parameters().rest();
    meshes_.back().by_values = colors(*scene.coloring, part);
    if (shown.surface)
      shown.values.emplace(scene.coloring->by, part.s(shown.surface->material(), rest),
                           shown.surface->triangles());
    else
      shown.values.emplace(scene.coloring->by, shown.nodes.of(part.local()->mesh().X), shown.nodes.triangles);
  }
  add_obstacles(scene, values);
  add_planes(scene, values);
}

void FrameMeshes::add_obstacles(const Scene& scene, Values values) {
  const auto& obstacles = model_->body().contact.obstacles;
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    if (!scene.obstacles.at(k).visible) continue;
    const ObstacleMesh mesh(obstacles[k].vertices, obstacles[k].triangles);
    NamedMesh named{obstacles[k].name, scene.obstacles[k].color, faceted(mesh)};
    if (scene.coloring && values == Values::included) named.values = VecX<double>::Zero(named.mesh.x.cols());
    obstacles_.push_back({&obstacles[k], std::move(named)});
  }
}

void FrameMeshes::add_planes(const Scene& scene, Values values) {
  for (const PlaneLook& look : scene.planes) {
    const ContactPlane& plane = model_->body().contact.planes.at(look.plane);
    NamedMesh named{plane.name, look.color, faceted(rectangle(look, plane.normal))};
    if (scene.coloring && values == Values::included) named.values = VecX<double>::Zero(named.mesh.x.cols());
    planes_.push_back({&plane, std::move(named)});
  }
}

Eigen::Matrix3Xd FrameMeshes::vertices(const Shown& shown, const State& state) const {
  const int part = static_cast<int>(shown.part);
  if (!shown.surface) return shown.nodes.of(model_->node_positions(state, part));
  if (shown.rigid) return shown.body.x;
  return model_->parts()[shown.part].part->s(shown.surface->material(), model_->values(state, part));
}

TriangleMesh FrameMeshes::body_mesh(const Shown& shown, const State& state) const {
  if (!shown.surface) return node_mesh(shown.nodes.triangles, vertices(shown, state));
  return shown.surface->body_mesh(*model_->parts()[shown.part].part,
                                  model_->values(state, static_cast<int>(shown.part)));
}

const std::vector<NamedMesh>& FrameMeshes::at(const State& state) {
  for (std::size_t k = 0; k < shown_.size(); ++k) {
    const Shown& shown = shown_[k];
    const int part = static_cast<int>(shown.part);
    const Vec3<double> c = model_->position(state, part);
    const Mat3<double> R = model_->orientation(state, part).toRotationMatrix();
    NamedMesh& named = meshes_[k];
    TriangleMesh& mesh = named.mesh;
    if (!shown.rigid) mesh = body_mesh(shown, state);
    const TriangleMesh& body = shown.rigid ? shown.body : mesh;
    if (shown.values && (!shown.rigid || named.values.size() == 0)) named.values = shown.values->at(body.x);
    mesh.x = (R * body.x).colwise() + c;
    mesh.normals = R * body.normals;
    if (shown.rigid && mesh.triangles.cols() == 0) {
      mesh.triangles = body.triangles;
      mesh.corners = body.corners;
    }
  }
  std::size_t there = shown_.size();  // meshes set so far; obstacles and planes may appear and disappear
  auto show = [&](const NamedMesh& mesh) -> NamedMesh& {
    if (there == meshes_.size() || meshes_[there].name != mesh.name) {
      meshes_.resize(there);
      meshes_.push_back(mesh);
    }
    return meshes_[there++];
  };
  for (const auto& [obstacle, mesh] : obstacles_)
    if (obstacle->acts_at(state.time())) show(mesh);
  for (const auto& [plane, mesh] : planes_)
    if (plane->acts_at(state.time()))
      show(mesh).mesh.x = mesh.mesh.x.colwise() + plane->point.value(state.time());
  meshes_.resize(there);
  return meshes_;
}

Eigen::AlignedBox3d FrameMeshes::bounds(const State& state) const {
  Eigen::AlignedBox3d box;
  for (const Shown& shown : shown_) {
    const int part = static_cast<int>(shown.part);
    const Mat3<double> R = model_->orientation(state, part).toRotationMatrix();
    const Eigen::Matrix3Xd x = (R * vertices(shown, state)).colwise() + model_->position(state, part);
    box.extend(Vec3<double>(x.rowwise().minCoeff()));
    box.extend(Vec3<double>(x.rowwise().maxCoeff()));
  }
  for (const auto& [obstacle, mesh] : obstacles_) {
    box.extend(Vec3<double>(mesh.mesh.x.rowwise().minCoeff()));
    box.extend(Vec3<double>(mesh.mesh.x.rowwise().maxCoeff()));
  }
  for (const auto& [plane, mesh] : planes_) {
    if (!plane->acts_at(state.time())) continue;
    const Vec3<double> point = plane->point.value(state.time());
    box.extend(point + mesh.mesh.x.rowwise().minCoeff());
    box.extend(point + mesh.mesh.x.rowwise().maxCoeff());
  }
  return box;
}

std::optional<double> FrameMeshes::high_value(const State& state) const {
  std::vector<double> all;
  for (std::size_t k = 0; k < shown_.size(); ++k) {
    if (!meshes_[k].by_values) continue;
    const VecX<double> values = shown_[k].values->at(vertices(shown_[k], state));
    all.insert(all.end(), values.begin(), values.end());
  }
  if (all.empty()) return std::nullopt;
  const auto high = all.end() - 1 - static_cast<std::ptrdiff_t>(all.size() / 100);
  std::nth_element(all.begin(), high, all.end());
  return *high;
}

std::int64_t FrameMeshes::triangles() const {
  std::int64_t sum = 0;
  for (const Shown& shown : shown_)
    sum += shown.surface ? shown.surface->triangles().cols() : shown.nodes.triangles.cols();
  for (const auto& [obstacle, mesh] : obstacles_) sum += mesh.mesh.triangles.cols();
  for (const auto& [plane, mesh] : planes_) sum += mesh.mesh.triangles.cols();
  return sum;
}

}  // namespace pliant
