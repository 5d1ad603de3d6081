#include <pliant/io/frame_meshes.h>

namespace pliant {

FrameMeshes::FrameMeshes(const Scene& scene, const Model& model) : model_(&model) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const Appearance& look = scene.appearance.at(i);
    if (!look.visible) continue;
    const Part& part = *model.parts()[i].part;
    const bool rigid = part.rigid();
    shown_.push_back({i, Surface(part, part.local() == nullptr ? look.resolution : 1), rigid, {}});
    if (rigid) shown_.back().body = shown_.back().surface.body_mesh(part, part.parameters().rest());
    meshes_.push_back({part.name(), look.color, {}});
  }
}

const std::vector<NamedMesh>& FrameMeshes::at(const State& state) {
  for (std::size_t k = 0; k < shown_.size(); ++k) {
    const Shown& shown = shown_[k];
    const int part = static_cast<int>(shown.part);
    const Vec3<double> c = model_->position(state, part);
    const Eigen::Quaterniond R = model_->orientation(state, part);
    TriangleMesh& mesh = meshes_[k].mesh;
    if (const LocalDeformation* local = model_->parts()[shown.part].local) {
      mesh = node_mesh(local->mesh(), model_->node_positions(state, part));
      mesh.x = (R.toRotationMatrix() * mesh.x).colwise() + c;
      mesh.normals = R.toRotationMatrix() * mesh.normals;
      continue;
    }
    if (!shown.rigid) {
      mesh = shown.surface.world_mesh(*model_->parts()[shown.part].part, model_->values(state, part), c, R);
      continue;
    }
    const Mat3<double> turn = R.toRotationMatrix();
    mesh.x = (turn * shown.body.x).colwise() + c;
    mesh.normals = turn * shown.body.normals;
    if (mesh.triangles.cols() == 0) {
      mesh.triangles = shown.body.triangles;
      mesh.corners = shown.body.corners;
    }
  }
  return meshes_;
}

Eigen::AlignedBox3d FrameMeshes::bounds(const State& state) {
  Eigen::AlignedBox3d box;
  for (const Shown& shown : shown_) {
    const int part = static_cast<int>(shown.part);
    const Part& solid = *model_->parts()[shown.part].part;
    const Mat3<double> turn = model_->orientation(state, part).toRotationMatrix();
    const Eigen::Matrix3Xd of_body =
        solid.local() != nullptr
            ? Eigen::Matrix3Xd(model_->node_positions(state, part).transpose())
            : (shown.rigid ? shown.body.x : solid.s(shown.surface.material(), model_->values(state, part)));
    const Eigen::Matrix3Xd x = (turn * of_body).colwise() + model_->position(state, part);
    box.extend(Vec3<double>(x.rowwise().minCoeff()));
    box.extend(Vec3<double>(x.rowwise().maxCoeff()));
  }
  return box;
}

std::int64_t FrameMeshes::triangles() const {
  std::int64_t sum = 0;
  for (const Shown& shown : shown_) {
    const LocalDeformation* local = model_->parts()[shown.part].local;
    sum += local == nullptr ? shown.surface.triangles().cols() : local->mesh().triangles.cols();
  }
  return sum;
}

}  // namespace pliant
