#include <pliant/solve/joint_solver.h>

namespace pliant {

namespace {
/// ns for each multiplication, block by block and where the factor is dense, and each number of the factor.
constexpr double kBlockProduct = 0.6, kDenseProduct = 0.25, kBlockValue = 1;
/// The same of a general sparse factor, and what it costs to begin.
constexpr double kSparseProduct = 1.2, kSparseValue = 12, kSparseStart = 4000;
}  // namespace

bool augmented_is_faster(const Elimination& blocks, const Elimination& augmented) {
  auto size = [](long n) { return static_cast<double>(n); };
  return kSparseStart + kSparseProduct * size(augmented.products) + kSparseValue * size(augmented.values) <
         kBlockProduct * size(blocks.products - blocks.dense_products) +
             kDenseProduct * size(blocks.dense_products) + kBlockValue * size(blocks.values);
}

}  // namespace pliant
