// The surface meshes of all visible parts, obstacles and planes at a state, for pictures and mesh files.
// Vertex values are the strain or the displacement that the scene's coloring selects.
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
  std::string name;  ///< name of the part, obstacle or plane
  Color color{};
  TriangleMesh mesh;       ///< m, world
  VecX<double> values{};   ///< quantity of the scene's coloring at each vertex; empty without a coloring, or
                           ///< with Values::omitted
  bool by_values = false;  ///< whether pictures colour the mesh by `values`
};

class FrameMeshes {
 public:
  /// Whether the meshes include the vertex values of the scene's coloring.
  enum class Values { included, omitted };

  /// Makes the surfaces of the visible parts, obstacles and planes. Planes and open obstacles get triangles
  /// for both sides. Scene and model must outlive the object. Throws std::invalid_argument if a resolution
  /// is out of range.
  FrameMeshes(const Scene& scene, const Model& model, Values values = Values::included);

  /// Returns the meshes at a state: the parts in the order of the model, then the obstacles and planes that
  /// act at the time of the state. The reference is valid until the next call. The mesh of a rigid part is
  /// evaluated once, and later only moved.
  const std::vector<NamedMesh>& at(const State& state);
  /// Returns the bounding box of the visible parts, all visible obstacles, and the planes that act at the
  /// time of the state, m, world.
  Eigen::AlignedBox3d bounds(const State& state) const;
  /// Returns the 99th percentile of the vertex values of all parts coloured by values, or std::nullopt if
  /// no visible part is coloured by values. The maximum is not used, because at a point force it grows
  /// without bound as the mesh is refined.
  std::optional<double> high_value(const State& state) const;
  /// Returns the number of triangles of all visible parts, obstacles and planes.
  std::int64_t triangles() const;

 private:
  struct Shown {
    std::size_t part;
    bool rigid;
    std::optional<Surface> surface;  // for a part without local deformation
    SurfaceNodes nodes;              // for a part with local deformation
    TriangleMesh body;               // for a rigid part: its mesh in the body frame
    std::optional<SurfaceValues> values;
  };
  void add_obstacles(const Scene& scene, Values values);
  void add_planes(const Scene& scene, Values values);
  Eigen::Matrix3Xd vertices(const Shown& shown, const State& state) const;
  TriangleMesh body_mesh(const Shown& shown, const State& state) const;

  const Model* model_;
  /// A visible obstacle or plane. The mesh of a plane is relative to the point of the plane.
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
