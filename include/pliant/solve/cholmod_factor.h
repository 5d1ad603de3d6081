// The sparse Cholesky factorisation of SuiteSparse (CHOLMOD) for large systems, in the library
// pliant::suitesparse. The supernodal module of CHOLMOD is under the GNU General Public License; the core
// library does not link CHOLMOD.
#pragma once

#include <memory>

#include <pliant/math/sparse_factor.h>

namespace pliant {

struct CholmodOptions {
  /// Smallest number of unknowns for the supernodal method (dense blocks, BLAS). Smaller matrices, and all
  /// quasi-definite ones, use the simplicial method.
  Eigen::Index supernodal_from = 4000;
};

/// Returns a factorisation by CHOLMOD. The first call limits a threaded OpenBLAS to one thread for the whole
/// process: more threads do not help at these sizes, and results would depend on their number. Functions of
/// the factorisation throw std::bad_alloc if CHOLMOD needs more memory than there is, and std::runtime_error
/// if CHOLMOD reports another error.
std::unique_ptr<SparseFactor> make_cholmod_factor(const CholmodOptions& options = {});

}  // namespace pliant
