// Weights of a patch of nodes around a material point of a part with nodes. A force at the point is spread
// over the patch, so that its effect does not depend on the resolution of the mesh. The weights decrease
// smoothly with the distance r, phi = (1 - r^2/R^2)^2 with the radius R, and reproduce the position of the
// material point m at rest,
//   sum w = 1,   sum w X = X(m),
// so that a force keeps its torque.
#pragma once

#include <pliant/part/local/local_mesh.h>

namespace pliant {

/// Returns weights over the nodes within a radius (m) of the point at rest. A point of the surface uses the
/// nodes of the surface, in proportion to their areas; any other point uses all nodes, in proportion to their
/// masses. A correction, for a solid at all nodes within the radius, makes the weights reproduce X(m). If
/// there are fewer than five such nodes, or if no weights of moderate size reproduce X(m), returns
/// mesh_weights(): the weights of the element or triangle around the point, empty inside a shell.
NodeWeights patch_weights(const Part& part, const LocalMesh& mesh, const Material<double>& m, double radius);

}  // namespace pliant
