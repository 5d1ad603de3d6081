// Eigenvalues of dense matrices. The functions are compiled once, in src, because Eigen's solvers compile
// slowly.
#pragma once

#include <complex>

#include <pliant/math/types.h>

namespace pliant {

/// Eigenvalues and eigenvectors v: A v = value v with |v| = 1, or A v = value B v with v^T B v = 1.
struct Eigenpairs {
  VecX<double> values;   ///< ascending
  MatX<double> vectors;  ///< one eigenvector per column
};

/// Returns the eigenvalues and eigenvectors of a symmetric matrix, n x n. Only the lower triangle of A is
/// read. The results are not finite if an entry of A is not finite.
Eigenpairs symmetric_eigenpairs(const Eigen::Ref<const MatX<double>>& A);
/// Returns the eigenvalues of a symmetric matrix, n x n, in ascending order. Only the lower triangle is read.
VecX<double> symmetric_eigenvalues(const Eigen::Ref<const MatX<double>>& A);

/// Returns the solutions of A v = value B v, where A and B are symmetric and B is positive definite.
Eigenpairs symmetric_eigenpairs(const Eigen::Ref<const MatX<double>>& A,
                                const Eigen::Ref<const MatX<double>>& B);

/// Eigenvalues and eigenvectors v of any square matrix: A v = value v with |v| = 1, in no particular order.
struct ComplexEigenpairs {
  VecX<std::complex<double>> values;
  MatX<std::complex<double>> vectors;  ///< one eigenvector per column
};
/// Returns the eigenvalues and eigenvectors of A, n x n.
ComplexEigenpairs eigenpairs(const Eigen::Ref<const MatX<double>>& A);
/// Returns the eigenvalues of any square matrix, in no particular order.
VecX<std::complex<double>> eigenvalues(const Eigen::Ref<const MatX<double>>& A);

/// Returns the largest |eigenvalue| of any square matrix.
double spectral_radius(const Eigen::Ref<const MatX<double>>& A);

}  // namespace pliant
