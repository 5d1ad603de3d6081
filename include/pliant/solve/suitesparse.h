// SuiteSparse for joint systems, in the library pliant::suitesparse: CHOLMOD factors the augmented matrix,
// AMD orders the blocks.
#pragma once

#include <pliant/solve/joint_solver.h>

namespace pliant {

/// Returns the approximate minimum degree order (Amestoy, Davis & Duff 2004); see NodeOrder for the
/// arguments. Throws std::bad_alloc if CHOLMOD fails.
std::vector<int> amd_order(const std::vector<int>& first, const std::vector<int>& neighbour);

/// Selects CHOLMOD and amd_order in a joint solver.
void use_suitesparse(JointSolver& solver);

}  // namespace pliant
