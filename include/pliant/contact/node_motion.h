// Places and velocities of nodes of parts that deform at the nodes of a mesh.
#pragma once

#include <vector>

#include <pliant/body/model.h>

namespace pliant {

/// Velocities of some nodes of a part that deforms at them, columns, m/s, world.
void node_velocities(const Model& model, const State& state, int part, const std::vector<int>& nodes,
                     Eigen::Matrix3Xd& x_dot);

}  // namespace pliant
