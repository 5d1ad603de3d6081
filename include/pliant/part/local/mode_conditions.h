// The reference conditions W^T d = 0 at the rest shape (include/pliant/part/local/README.md), and the modes
// under these conditions.
#pragma once

#include <pliant/part/local/modal_basis.h>

namespace pliant {

/// Returns G0 = [I, -[X]x, J] of n points with rest positions X: 3n x (6 + n_s). Rows: x of all n points,
/// then y, then z.
MatX<double> rest_frame(const Part& part, const std::vector<Material<double>>& points, const Nodes& X);
/// Returns G0 of the spectral nodes of a basis.
MatX<double> rest_frame(const Part& part, const ModalBasis& basis);

/// Returns an orthonormal basis of the span of the columns of A. Columns are scaled to length 1 and chosen in
/// the order of QR with column pivoting. A column whose distance from the span of the chosen columns is at
/// most `dependent` is ignored.
MatX<double> orthonormal_basis(MatX<double> A, double dependent);

/// Computes B and omega2 of a basis: all modes of the stiffness K under W^T d = 0. K (3N x 3N, N/m) is over
/// the coefficients d_a of the N fields of the basis: all x, then y, then z. The masses m_a must be equal,
/// and the fields must span the constant and X. Throws std::invalid_argument if the conditions leave no mode.
void diagonalise(const Part& part, const MatX<double>& K, ModalBasis& basis);

}  // namespace pliant
