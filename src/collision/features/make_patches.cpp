// Division of the features of a part into patches, with their balls and cones of normals.
#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>

#include <pliant/part/mesh/surface.h>

#include "patch_tree.h"

namespace pliant {

namespace {

/// Edges of the mesh of a smooth solid along an eighth of a great circle.
constexpr int kPatchResolution = 3;
/// Largest turn of the normal over a patch of a rim or side, rad.
constexpr double kPatchTurn = 0.5;
/// Factor by which the ball of a patch is larger than the ball of its sampled points.
constexpr double kBallMargin = 1.1;
/// Angle by which the half angle of a cone exceeds the largest angle of a sampled normal to its axis, rad.
constexpr double kNormalMargin = 0.03;
/// Least factor by which a deformation may shorten a tangent, and least sine of the angle between tangents.
constexpr double kLeastStretch = 1e-6;
/// On a smooth solid, the normal turns from the middle to the border of a patch by an angle that is estimated
/// as this share of the angle between the normals at the middles of neighbouring patches.
constexpr double kBorder = 0.6;

/// Appends the outward normals of the adjacent faces at a point of a feature.
void add_normals(const FeatureJet& jet, std::vector<Vec3<double>>& normals) {
  if (jet.dimension == 2) return normals.push_back(jet.normal);
  const int n = jet.n_inward;
  for (int i = 0; i < n; ++i) {
    // At an edge, face i contains the inward direction i and the edge. At a vertex, face i contains the
    // inward directions i and i + 1.
    const Vec3<double>& one = jet.inward[static_cast<std::size_t>(i)];
    const Vec3<double> other = jet.dimension == 1 ? Vec3<double>(jet.tangents.col(0))
                                                  : jet.inward[static_cast<std::size_t>((i + 1) % n)];
    const Vec3<double>& inside = jet.inward[static_cast<std::size_t>((i + n - 1) % n)];
    const Vec3<double> normal = one.cross(other).normalized();
    normals.push_back(normal.dot(inside) < 0 ? normal : Vec3<double>(-normal));
  }
}

/// Sets the cone of a bound so that it contains the normals.
void set_cone(const std::vector<Vec3<double>>& normals, PatchBound& bound) {
  Vec3<double> sum = Vec3<double>::Zero();
  for (const Vec3<double>& normal : normals) sum += normal;
  bound.axis = sum.normalized();
  double angle = 0;
  for (const Vec3<double>& normal : normals) angle = std::max(angle, angle_between(normal, bound.axis));
  bound.set_angle(angle + kNormalMargin);
}

void add_smooth(const Part& part, const ParameterValues<double>& values, const PartFeatures& features,
                std::vector<Patch>& patches) {
  const Surface surface(part, kPatchResolution);
  for (const Vec3<double>& place : surface.places()) {
    Patch patch;
    patch.middle.e = part.shape().e(part.shape().mesh_label(place, values.b.data()), values.b.data());
    patch.jet = features.evaluate(patch.middle);
    patch.bound.centre = patch.jet.x;
    patch.bound.axis = patch.jet.normal;
    patch.bound.radius = 0;
    patches.push_back(patch);
  }
  std::vector<double> angles(patches.size(), 0);
  for (Eigen::Index t = 0; t < surface.triangles().cols(); ++t) {
    const Eigen::Vector3i corners = surface.triangles().col(t);
    auto patch = [&](int k) -> Patch& { return patches[static_cast<std::size_t>(corners[k % 3])]; };
    const Vec3<double> middle = (patch(0).jet.x + patch(1).jet.x + patch(2).jet.x) / 3;
    for (int k = 0; k < 3; ++k) {
      Patch& own = patch(k);
      double& angle = angles[static_cast<std::size_t>(corners[k])];
      own.bound.radius = std::max(own.bound.radius, kBallMargin * (middle - own.jet.x).norm());
      for (const Patch* other : {&patch(k + 1), &patch(k + 2)}) {
        own.bound.radius = std::max(own.bound.radius, 0.5 * kBallMargin * (other->jet.x - own.jet.x).norm());
        angle = std::max(angle, kBorder * angle_between(own.jet.normal, other->jet.normal));
      }
    }
  }
  for (std::size_t k = 0; k < patches.size(); ++k) patches[k].bound.set_angle(angles[k] + kNormalMargin);
}

void add_grid(const PartFeatures& features, int feature, std::vector<Patch>& patches) {
  Eigen::Vector2d step;
  for (const FeaturePoint& middle : features.grid(feature, kPatchTurn, step)) {
    Patch patch;
    patch.middle = middle;
    patch.jet = features.evaluate(middle);
    patch.bound.centre = patch.jet.x;
    patch.bound.radius = 0;
    std::vector<Vec3<double>> normals;
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const Eigen::Vector2d ds(patch.jet.dimension > 0 ? 0.5 * i * step[0] : 0,
                                 patch.jet.dimension > 1 ? 0.5 * j * step[1] : 0);
        const FeatureJet border = features.evaluate(features.moved(middle, patch.jet, ds));
        patch.bound.radius = std::max(patch.bound.radius, kBallMargin * (border.x - patch.jet.x).norm());
        add_normals(border, normals);
      }
    set_cone(normals, patch.bound);
    patches.push_back(patch);
  }
}

}  // namespace

bool is_regular(const Patch& patch) {
  const FeatureJet& jet = patch.jet;
  const PatchBound& bound = patch.bound;
  if (!jet.x.allFinite() || !jet.tangents.allFinite() || !jet.second.allFinite() || !jet.normal.allFinite())
    return false;
  for (int k = 0; k < jet.dimension; ++k)
    if (!(jet.tangents.col(k).norm() > kLeastStretch * jet.undeformed_tangents.col(k).norm())) return false;
  if (jet.dimension == 2 &&
      !(jet.tangents.col(0).normalized().cross(jet.tangents.col(1).normalized()).norm() > kLeastStretch))
    return false;
  return std::isfinite(bound.radius) && std::isfinite(bound.angle) &&
         std::abs(bound.axis.norm() - 1) < kLeastStretch;
}

std::vector<Patch> make_patches(const Part& part, const ParameterValues<double>& values,
                                const PartFeatures& features) {
  std::vector<Patch> patches;
  if (features.is_smooth_solid())
    add_smooth(part, values, features, patches);
  else
    for (int feature = 0; feature < features.count(); ++feature) add_grid(features, feature, patches);
  return patches;
}

}  // namespace pliant
