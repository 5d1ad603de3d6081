// The displacement fields that a basis of modes must leave out, and the modes of the remaining fields.
#pragma once

#include <pliant/part/local/modal_basis.h>

namespace pliant {

/// Returns G0 = [I, -[X]x, J] of n points at X, at the rest shape: 3n x (6 + n_s), all x, then y, then z.
MatX<double> rest_frame(const Part& part, const std::vector<Material<double>>& points, const Nodes& X);
/// Returns G0 of the spectral nodes of a basis.
MatX<double> rest_frame(const Part& part, const ModalBasis& basis);

/// Returns an orthonormal basis of the span of the columns of A. dependent: a column whose distance from the
/// span of the others is below this fraction of its length is ignored.
MatX<double> orthonormal_basis(MatX<double> A, double dependent);

/// Computes B and omega2 of a basis: all modes of the stiffness K under W^T d = 0. K (3N x 3N, N/m) is over
/// the coefficients d_a of the N fields of the basis: all x, then y, then z. The fields must have equal
/// masses and span the constant and X.
void diagonalise(const Part& part, const MatX<double>& K, ModalBasis& basis);

}  // namespace pliant
