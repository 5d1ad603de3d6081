// How the system of the joints is solved: by blocks of W_c = C_q M^-1 C_q^T, whose size is the number of
// rows, or as the augmented matrix of Eq. (14), sparse, for parts that very many joints hold on to.
#pragma once

#include <functional>
#include <memory>

#include <pliant/math/sparse_factor.h>
#include <pliant/solve/block_pattern.h>

namespace pliant {

struct JointSolver {
  enum class Choice { automatic, blocks, augmented };
  Choice choice = Choice::automatic;
  /// Of the augmented matrix, and of the stiffness of nodes where a method of integration factors it.
  MakeSparseFactor make_factor = make_eigen_factor;
  /// A fill-reducing order for the blocks, beside the cardinality search.
  NodeOrder order = minimum_degree_order;
};

/// Whether the augmented matrix is expected to be faster, for eliminations of both: a fixed model of the cost
/// of a factorisation, which bench/joint_bench checks.
bool augmented_is_faster(const Elimination& blocks, const Elimination& augmented);

}  // namespace pliant
