// The cost model that chooses between blocks and the augmented matrix.
#pragma once

#include <pliant/solve/joint_solver.h>

#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {
/// Cost of the blocks in ns: for a multiplication in a block, for one in the dense matrix, and for a number
/// of the factor.
inline constexpr double kBlockProduct = 0.6, kDenseProduct = 0.25, kBlockValue = 1;
/// Cost of a general sparse factor in ns: for a multiplication, for a number of the factor, and a constant.
inline constexpr double kSparseProduct = 1.2, kSparseValue = 12, kSparseStart = 4000;
}  // namespace detail

PLIANT_INLINE bool augmented_is_faster(const Elimination& blocks, const Elimination& augmented) {
  auto size = [](long n) { return static_cast<double>(n); };
  return detail::kSparseStart + detail::kSparseProduct * size(augmented.products) +
             detail::kSparseValue * size(augmented.values) <
         detail::kBlockProduct * size(blocks.products - blocks.dense_products) +
             detail::kDenseProduct * size(blocks.dense_products) + detail::kBlockValue * size(blocks.values);
}

}  // namespace pliant
