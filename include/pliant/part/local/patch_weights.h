// Weights w of a patch of nodes around a material point m. A force at the point is spread over the patch, so
// that the effect of the force does not depend on the resolution of the mesh. Before a correction, w is
// proportional to phi = (1 - r^2/R^2)^2, with the distance r of the node at rest and the radius R. The
// corrected weights reproduce the position X(m) of the point at rest,
//   sum w = 1,   sum w X = X(m),
// so that the forces on the patch have the torque of the force at the point.
#pragma once

#include <pliant/part/local/local_mesh.h>

namespace pliant {

/// Returns weights over the nodes within a radius (m) of the point at rest. For a point of the surface, phi
/// multiplies the areas of the nodes of the surface; for any other point, phi multiplies the masses of all
/// nodes. A correction then makes the weights reproduce X(m). For a solid, the correction changes the weights
/// of all nodes within the radius, also inside the body. Returns mesh_weights() instead if fewer than five
/// nodes have a positive phi times area or mass, or if the corrected weights do not reproduce X(m) or have a
/// sum of |w| above 4. The result is empty inside a shell.
NodeWeights patch_weights(const Part& part, const LocalMesh& mesh, const Material<double>& m, double radius);

}  // namespace pliant
