// Contacts of a part without local deformation with a mesh: on the flat faces its low points, as on a plane;
// on ridges and at corners what of them is deepest in the part, where the part's normal there lies between
// those of the faces that meet. So the joints of a flat floor are not felt, and a ball rolls over a ridge
// smoothly.
#pragma once

#include <vector>

#include <pliant/contact/collision_surface.h>
#include <pliant/contact/contact.h>
#include <pliant/contact/obstacle_mesh.h>

namespace pliant {

/// A part where it is.
struct PlacedSurface {
  const Part& part;
  const CollisionSurface& surface;
  const ParameterValues<double>& values;
  const Vec3<double>& c;           ///< of its frame, world
  const Mat3<double>& R;           ///< body to world
  const Eigen::Matrix3Xd& p;       ///< points of the surface, body frame
  const Eigen::AlignedBox3d& box;  ///< around these, world
};

/// Adds the contacts whose gap is at most `most` (m): material of side a, x, normal and gap; the rest is the
/// caller's.
void find_on_mesh(const PlacedSurface& a, const ObstacleMesh& mesh, double most, std::vector<Contact>& found);

}  // namespace pliant
