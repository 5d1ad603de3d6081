// Orthonormal bases of the columns of dense matrices, and least squares, by Householder's QR. The functions
// are compiled once, in src, because Eigen's QR factorisations compile slowly.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// Returns an orthonormal basis (n x m) of the space that the columns of A span. A: n x m, of rank m.
MatX<double> column_basis(const MatX<double>& A);
/// Returns an orthonormal basis (n x r) of the space that the columns of A span, for A of any rank. The QR
/// factorisation pivots columns; the rank r is the number of pivots larger than `dependent` times the largest
/// pivot, in absolute value.
MatX<double> column_basis(const MatX<double>& A, double dependent);

/// Returns an orthonormal basis, n x (n - m), of the vectors that are orthogonal to all columns of A. A:
/// n x m, of rank m.
MatX<double> complement_basis(const MatX<double>& A);
/// Returns an orthonormal basis, n x (n - r), of the vectors that are orthogonal to all columns of A. r is
/// the rank that column_basis(A, dependent) finds.
MatX<double> complement_basis(const MatX<double>& A, double dependent);

/// Returns an x that minimises |A x - b|. x is unique if the columns of A are independent.
VecX<double> least_squares(const MatX<double>& A, const VecX<double>& b);

/// Returns the x of least norm among those that minimise |A x - b|, for A of any rank.
VecX<double> least_norm(const MatX<double>& A, const VecX<double>& b);
/// Returns the pseudo-inverse of A, for A of any rank.
MatX<double> pseudo_inverse(const MatX<double>& A);

}  // namespace pliant
