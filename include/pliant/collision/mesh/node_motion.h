// Velocities of the mesh nodes of a part that deforms locally.
#pragma once

#include <vector>

#include <pliant/body/model.h>

namespace pliant {

/// Computes x_dot, the velocities of some nodes of a part: one column for each entry of `nodes`, m/s, world.
void node_velocities(const Model& model, const State& state, int part, const std::vector<int>& nodes,
                     Eigen::Matrix3Xd& x_dot);

}  // namespace pliant
