// Velocities of the nodes of the mesh of a part that deforms locally.
#pragma once

#include <vector>

#include <pliant/body/model.h>

namespace pliant {

/// Of some nodes of a part, columns, m/s, world.
void node_velocities(const Model& model, const State& state, int part, const std::vector<int>& nodes,
                     Eigen::Matrix3Xd& x_dot);

}  // namespace pliant
