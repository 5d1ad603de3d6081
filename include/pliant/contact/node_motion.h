// Places and velocities of nodes of parts that deform at the nodes of a mesh.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

struct NodeMotion {
  Vec3<double> x, x_dot;  ///< m and m/s, world
};

NodeMotion node_motion(const Model& model, const State& state, int part, int node);

}  // namespace pliant
