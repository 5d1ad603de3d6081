// The solver of the joint system: blocks of W_c = C_q M^-1 C_q^T, whose size is the number of constraint
// rows, or the sparse augmented matrix of Eq. (14), for parts with very many joints.
#pragma once

#include <functional>
#include <memory>

#include <pliant/math/sparse_factor.h>
#include <pliant/solve/block_pattern.h>

namespace pliant {

/// The choice of the solver and of its factorisations.
struct JointSolver {
  enum class Choice { automatic, blocks, augmented };
  Choice choice = Choice::automatic;
  /// Makes the factorisation of the augmented matrix. The linearly implicit methods of integration use it
  /// also for the stiffness matrices of parts with nodal local deformation.
  MakeSparseFactor make_factor = make_eigen_factor;
  /// A fill-reducing order for the blocks. The solver compares it with cardinality_order and uses the cheaper
  /// one.
  NodeOrder order = minimum_degree_order;
};

/// Returns whether the augmented matrix is expected to be faster than the blocks, from the eliminations of
/// both. The cost model is fixed; bench/joint_bench.cpp measures both solvers and prints the choice.
bool augmented_is_faster(const Elimination& blocks, const Elimination& augmented);

}  // namespace pliant
