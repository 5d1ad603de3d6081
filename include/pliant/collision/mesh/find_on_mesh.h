// Contacts of a part without local deformation with a mesh: on the flat faces its low points, as on a plane;
// on ridges and at corners what of them is deepest in the part, where the part's normal there lies between
// those of the faces that meet. So the joints of a flat floor are not felt, and a ball rolls over a ridge
// smoothly.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <pliant/collision/collision_surface.h>
#include <pliant/collision/contact.h>
#include <pliant/collision/mesh/obstacle_mesh.h>

namespace pliant {

/// A part where it is.
struct PlacedSurface {
  const Part& part;
  const CollisionSurface& surface;
  const ParameterValues<double>& values;
  const Vec3<double>& c;                    ///< of its frame, world
  const Mat3<double>& R;                    ///< body to world
  const std::optional<Vec3<double>>& axes;  ///< semi-axes of an ellipsoid
  Eigen::AlignedBox3d box;                  ///< around it, world
  /// Points of the surface, body frame; ellipsoids do without.
  std::function<const Eigen::Matrix3Xd&()> points;
};

/// What a search works with, kept from call to call: triangles near a part, and the faces, sharp edges and
/// corners of these.
struct MeshSearch {
  std::vector<int> triangles, faces, edges, vertices;
};

/// Adds the contacts whose gap is at most `most` (m): material of side a, x, normal and gap; the rest is the
/// caller's.
void find_on_mesh(const PlacedSurface& a, const ObstacleMesh& mesh, double most, MeshSearch& search,
                  std::vector<Contact>& found);

}  // namespace pliant
