// Contacts of a part without local deformation with an obstacle mesh. On a flat face of the mesh the contacts
// are the lowest points of the part, as over a plane. On a ridge or at a corner the contact is the point of
// the mesh that is deepest inside the part. At this point the normal of the part must be between the normals
// of the faces that meet. Thus edges inside a flat floor have no effect, and a ball rolls over a ridge
// smoothly.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include <pliant/collision/collision_surface.h>
#include <pliant/collision/contact.h>
#include <pliant/collision/mesh/obstacle_mesh.h>

#include "collision/hull/touch_plane.h"

namespace pliant {

/// A part and its pose.
struct PlacedSurface {
  const Part& part;
  const CollisionSurface& surface;
  const ParameterValues<double>& values;
  const Vec3<double>& c;                    ///< origin of the frame, m, world
  const Mat3<double>& R;                    ///< body to world
  const std::optional<Vec3<double>>& axes;  ///< semi-axes if the part is an ellipsoid, m
  const Hull* hull;  ///< support points of the part; nullptr for ellipsoids and for parts without a hull
  Eigen::AlignedBox3d box;  ///< contains the part, world
  /// Returns the sample points of the surface, body frame, m; called only if the part is no ellipsoid and has
  /// no hull.
  std::function<const Eigen::Matrix3Xd&()> points;
};

/// Scratch storage of a search.
struct MeshSearch {
  /// The triangles near a part, and their faces, sharp edges and corners, in ascending order.
  std::vector<int> triangles, faces, edges, vertices;
  /// Of each face in `faces`: whether the part is above its plane by more than max_gap.
  std::vector<bool> above;
  std::vector<Vec3<double>> hull_points;
  std::vector<PlaneTouch> of_face;
};

/// Appends the contacts whose gap is at most max_gap (m). Sets a.material, x, normal and gap of each contact;
/// the caller sets the other members.
void find_on_mesh(const PlacedSurface& a, const ObstacleMesh& mesh, double max_gap, MeshSearch& search,
                  std::vector<Contact>& found);

}  // namespace pliant
