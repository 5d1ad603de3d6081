// The part under the mouse, and the material point under the mouse.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/scene/scene.h>
#include <pliant/view/orbit.h>

namespace pliant {

/// The first point of a mesh on a ray.
struct Hit {
  std::size_t mesh = 0;       ///< number of the mesh in the list
  Eigen::Index triangle = 0;  ///< column of TriangleMesh::triangles
  Vec3<double> weights;       ///< of the three corners; their sum is 1
  Vec3<double> position;      ///< m, world
};

/// Returns the hit that is nearest to the origin of the ray, or std::nullopt if the ray misses all meshes.
std::optional<Hit> first_hit(const std::vector<NamedMesh>& meshes, const Ray& ray);

/// The material points of the meshes that FrameMeshes makes of visible parts.
class SurfacePoints {
 public:
  /// scene, model: as for FrameMeshes.
  SurfacePoints(const Scene& scene, const Model& model);

  /// Returns the point of a part at a hit, with angles that a scene can express exactly, or
  /// std::nullopt for an obstacle or a plane. On a part with nodal deformation the point has a patch of
  /// a tenth of the size of the part, because a force on one node deforms the mesh only next to it.
  std::optional<Point> at(const Hit& hit) const;

 private:
  struct Shown {
    const Part* part;
    std::vector<Material<double>> vertices;
    Eigen::Matrix3Xi triangles;  // columns of `vertices`
  };
  std::vector<Shown> shown_;
};

}  // namespace pliant
