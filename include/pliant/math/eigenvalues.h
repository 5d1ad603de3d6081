// Eigenvalues of dense matrices, compiled once: Eigen's solvers take long to compile.
#pragma once

#include <complex>

#include <pliant/math/types.h>

namespace pliant {

/// A v = value v with |v| = 1, or A v = value B v with v^T B v = 1.
struct Eigenpairs {
  VecX<double> values;   ///< ascending
  MatX<double> vectors;  ///< a column each
};

/// Of a symmetric matrix, of which the lower triangle is read. What is not finite gives what is not finite.
Eigenpairs symmetric_eigenpairs(const Eigen::Ref<const MatX<double>>& A);
VecX<double> symmetric_eigenvalues(const Eigen::Ref<const MatX<double>>& A);

/// Of A v = value B v, both symmetric and B positive definite.
Eigenpairs symmetric_eigenpairs(const Eigen::Ref<const MatX<double>>& A,
                                const Eigen::Ref<const MatX<double>>& B);

/// Of any square matrix, in no order.
VecX<std::complex<double>> eigenvalues(const Eigen::Ref<const MatX<double>>& A);

/// The largest |eigenvalue| of any square matrix.
double spectral_radius(const Eigen::Ref<const MatX<double>>& A);

}  // namespace pliant
