// The sparse Cholesky factorisation of SuiteSparse (CHOLMOD), in the library pliant::suitesparse: for large
// systems. Its supernodal part is under the GNU General Public License; nothing of it is linked by core.
#pragma once

#include <memory>

#include <pliant/math/sparse_factor.h>

namespace pliant {

struct CholmodOptions {
  /// Unknowns from which the supernodal method (dense blocks, BLAS) is used instead of the simplicial one,
  /// which quasi-definite matrices always use.
  Eigen::Index supernodal_from = 4000;
};

/// Making the first one sets an OpenBLAS that has threads to one thread, for the whole process: more never
/// help at these sizes, and results would depend on their number.
std::unique_ptr<SparseFactor> make_cholmod_factor(const CholmodOptions& options = {});

}  // namespace pliant
