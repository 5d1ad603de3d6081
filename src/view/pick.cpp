#include <pliant/view/pick.h>

#include <cmath>
#include <limits>

namespace pliant {
namespace {

constexpr double kPatch = 0.1;  // radius of the patch of nodes around a picked point, in sizes of the part

/// A point of a triangle on a ray: its distance from the origin of the ray, and the weights of the corners.
struct Crossing {
  double distance = std::numeric_limits<double>::infinity();
  Vec3<double> weights = Vec3<double>::Zero();
};

/// Returns the crossing of a ray with a triangle (Möller and Trumbore 1997). The distance is infinite if the
/// ray misses the triangle or comes from behind.
Crossing crossing(const Ray& ray, const Vec3<double>& a, const Vec3<double>& b, const Vec3<double>& c) {
  const Vec3<double> ab = b - a, ac = c - a, p = ray.direction.cross(ac);
  const double det = ab.dot(p);
  if (!(det > 0)) return {};  // seen from behind, or degenerate
  const Vec3<double> from_a = ray.origin - a, q = from_a.cross(ab);
  const double v = from_a.dot(p) / det, w = ray.direction.dot(q) / det, distance = ac.dot(q) / det;
  if (v < 0 || w < 0 || v + w > 1 || distance <= 0) return {};
  return {distance, {1 - v - w, v, w}};
}

}  // namespace

std::optional<Hit> first_hit(const std::vector<NamedMesh>& meshes, const Ray& ray) {
  std::optional<Hit> first;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const TriangleMesh& mesh = meshes[i].mesh;
    for (Eigen::Index k = 0; k < mesh.triangles.cols(); ++k) {
      const Crossing here = crossing(ray, mesh.x.col(mesh.triangles(0, k)), mesh.x.col(mesh.triangles(1, k)),
                                     mesh.x.col(mesh.triangles(2, k)));
      if (!(here.distance < nearest)) continue;
      nearest = here.distance;
      first = {i, k, here.weights, ray.origin + nearest * ray.direction};
    }
  }
  return first;
}

SurfacePoints::SurfacePoints(const Scene& scene, const Model& model) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const Appearance& look = scene.appearance.at(i);
    if (!look.visible) continue;
    const Part& part = *model.parts()[i].part;
    Shown& shown = shown_.emplace_back();
    shown.part = &part;
    if (part.local() == nullptr) {
      const Surface surface(part, look.resolution);
      shown.vertices = surface.material();
      shown.triangles = surface.triangles();
      continue;
    }
    const LocalMesh& mesh = part.local()->mesh();
    const SurfaceNodes surface = surface_nodes(mesh);
    for (const int node : surface.node) shown.vertices.push_back(mesh.nodes[static_cast<std::size_t>(node)]);
    shown.triangles = surface.triangles;
  }
}

std::optional<Point> SurfacePoints::at(const Hit& hit) const {
  if (hit.mesh >= shown_.size()) return {};
  const Shown& shown = shown_[hit.mesh];
  const bool torus = shown.part->shape().mesh() == MeshPattern::torus;
  Vec3<double> direction = Vec3<double>::Zero();                             // unless the part is a torus
  Eigen::Vector2d u = Eigen::Vector2d::Zero(), v = Eigen::Vector2d::Zero();  // cosine and sine, for a torus
  for (int k = 0; k < 3; ++k) {
    const auto vertex = static_cast<std::size_t>(shown.triangles(k, hit.triangle));
    const Material<double>& m = shown.vertices[vertex];
    direction += hit.weights[k] * Vec3<double>(m.cu.x * m.cv.x, m.cu.x * m.sv.x, m.su.x);
    u += hit.weights[k] * Eigen::Vector2d(m.cu.x, m.su.x);
    v += hit.weights[k] * Eigen::Vector2d(m.cv.x, m.sv.x);
  }
  MaterialAngles place = angles(material_towards(direction));
  if (torus) place = {std::atan2(u[1], u[0]), std::atan2(v[1], v[0]), 1};
  const LocalDeformation* local = shown.part->local();
  const bool has_nodes = local != nullptr && local->nodal() != nullptr;
  return point(*shown.part, material_at(place.u, place.v, 1), has_nodes ? kPatch * shown.part->size() : 0);
}

}  // namespace pliant
