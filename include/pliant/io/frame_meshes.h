// The surfaces of all visible parts at a state: what meshes and pictures of a frame are made of.
#pragma once

#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/body/model.h>
#include <pliant/part/surface.h>
#include <pliant/scene/scene.h>

namespace pliant {

struct NamedMesh {
  std::string name;  ///< of the part
  Color color{};
  TriangleMesh mesh;  ///< world
};

class FrameMeshes {
 public:
  /// Lays the surfaces of the visible parts. Both must outlive it. Throws std::invalid_argument on a bad
  /// resolution.
  FrameMeshes(const Scene& scene, const Model& model);

  /// The meshes at a state, in the order of the parts; the reference is valid until the next call. Meshes of
  /// rigid parts are evaluated once and then only moved.
  const std::vector<NamedMesh>& at(const State& state);
  /// The box around all vertices at a state.
  Eigen::AlignedBox3d bounds(const State& state);
  std::int64_t triangles() const;

 private:
  struct Shown {
    std::size_t part;
    Surface surface;
    bool rigid;
    TriangleMesh body;  // of a rigid part, body frame
  };

  const Model* model_;
  std::vector<Shown> shown_;
  std::vector<NamedMesh> meshes_;
};

}  // namespace pliant
