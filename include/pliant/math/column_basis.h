// Orthonormal bases of the columns of dense matrices, and least squares, by Householder's QR. They are
// compiled once, in src, because Eigen's QR factorisations compile slowly.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// Returns an orthonormal basis of the columns of A, n x r. A: n x m, of rank m; then r = m.
MatX<double> column_basis(const MatX<double>& A);
/// Returns an orthonormal basis of the columns of A, n x r. Columns are pivoted; r is the number of pivots
/// larger than `dependent` times the largest pivot.
MatX<double> column_basis(const MatX<double>& A, double dependent);

/// Returns an orthonormal basis of the vectors orthogonal to all columns of A, n x (n - m). A: n x m, of rank
/// m.
MatX<double> complement_basis(const MatX<double>& A);
/// Returns an orthonormal basis of the vectors orthogonal to all columns of A, n x (n - r), with the rank r
/// of column_basis(A, dependent).
MatX<double> complement_basis(const MatX<double>& A, double dependent);

/// Returns the x that minimises |A x - b|.
VecX<double> least_squares(const MatX<double>& A, const VecX<double>& b);

}  // namespace pliant
