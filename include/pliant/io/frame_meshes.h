// The surfaces of all visible parts, obstacles and planes at a state: what meshes and pictures of a frame are
// made of.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/body/model.h>
#include <pliant/io/surface_values.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/scene/scene.h>

namespace pliant {

struct NamedMesh {
  std::string name;  ///< of the part, obstacle or plane
  Color color{};
  TriangleMesh mesh;       ///< world
  VecX<double> values{};   ///< of its vertices, what the scene's coloring tells; empty without
  bool by_values = false;  ///< coloured by them
};

class FrameMeshes {
 public:
  /// Whether the values of vertices are told that the scene's coloring asks for.
  enum class Values { included, omitted };

  /// Lays the surfaces of the visible parts, obstacles and planes, these from both sides when they are open.
  /// Both must outlive it. Throws std::invalid_argument on a bad resolution.
  FrameMeshes(const Scene& scene, const Model& model, Values values = Values::included);

  /// The meshes at a state, in the order of the parts, the obstacles and planes that are there after them;
  /// the reference is valid until the next call. Meshes of rigid parts are evaluated once and then only
  /// moved.
  const std::vector<NamedMesh>& at(const State& state);
  /// The box around all vertices at a state.
  Eigen::AlignedBox3d bounds(const State& state) const;
  /// What 99 of 100 vertices stay below at a state, of the parts that are coloured by values; nothing when
  /// none is. The rest may be very far above: a force at a point stretches its vertex the more, the finer the
  /// mesh.
  std::optional<double> high_value(const State& state) const;
  std::int64_t triangles() const;

 private:
  struct Shown {
    std::size_t part;
    bool rigid;
    std::optional<Surface> surface;  // of a part without nodes
    SurfaceNodes nodes;              // of one with nodes
    TriangleMesh body;               // of a rigid part, body frame
    std::optional<SurfaceValues> values;
  };
  void add_obstacles(const Scene& scene, Values values);
  void add_planes(const Scene& scene, Values values);
  Eigen::Matrix3Xd vertices(const Shown& shown, const State& state) const;
  TriangleMesh body_mesh(const Shown& shown, const State& state) const;

  const Model* model_;
  /// An obstacle; or a plane, whose mesh is about its point.
  template <class Thing>
  struct ShownThing {
    const Thing* thing;
    NamedMesh mesh;
  };
  std::vector<Shown> shown_;
  std::vector<ShownThing<ContactObstacle>> obstacles_;
  std::vector<ShownThing<ContactPlane>> planes_;
  std::vector<NamedMesh> meshes_;
};

}  // namespace pliant
