// What acts at a material point of a part with nodes, spread over a patch of them, so that it does not depend
// on the size of the mesh: weights fall off smoothly, phi = (1 - r^2/R^2)^2, and reproduce the point at rest,
//   sum w = 1,   sum w X = X(m),
// so that a pull has its torque.
#pragma once

#include <pliant/part/local/local_mesh.h>

namespace pliant {

/// Weights over the nodes within a radius R (m) of where the point is at rest; of a point of the surface over
/// those of the surface, in proportion to their areas, else to their masses. Where the mesh has too few nodes
/// within it, those of the element around the point.
NodeWeights patch_weights(const Part& part, const LocalMesh& mesh, const Material<double>& m, double radius);

}  // namespace pliant
