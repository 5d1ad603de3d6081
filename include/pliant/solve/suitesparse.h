// SuiteSparse for systems of joints, in the library pliant::suitesparse: CHOLMOD factors the augmented
// matrix, AMD orders the blocks.
#pragma once

#include <pliant/solve/joint_solver.h>

namespace pliant {

/// Approximate minimum degree (Amestoy, Davis & Duff 2004).
std::vector<int> amd_order(const std::vector<int>& first, const std::vector<int>& neighbour);

void use_suitesparse(JointSolver& solver);

}  // namespace pliant
