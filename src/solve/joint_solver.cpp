// The cost model that chooses between blocks and the augmented matrix.
#include <pliant/solve/joint_solver.h>

namespace pliant {

namespace {
/// Cost of the blocks in ns: for a multiplication in a block and in the dense matrix, and for a number of the
/// factor.
constexpr double kBlockProduct = 0.6, kDenseProduct = 0.25, kBlockValue = 1;
/// Cost of a general sparse factor in ns: for a multiplication, for a number of the factor, and a constant.
constexpr double kSparseProduct = 1.2, kSparseValue = 12, kSparseStart = 4000;
}  // namespace

bool augmented_is_faster(const Elimination& blocks, const Elimination& augmented) {
  auto size = [](long n) { return static_cast<double>(n); };
  return kSparseStart + kSparseProduct * size(augmented.products) + kSparseValue * size(augmented.values) <
         kBlockProduct * size(blocks.products - blocks.dense_products) +
             kDenseProduct * size(blocks.dense_products) + kBlockValue * size(blocks.values);
}

}  // namespace pliant
