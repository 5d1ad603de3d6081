// What a basis must leave out, and the modes of what is left.
#pragma once

#include <pliant/part/local/modal_basis.h>

namespace pliant {

/// G0 = [I, -[X]x, J] of n points at X, at the rest shape: 3n x (6 + n_s), all x, then y, then z.
MatX<double> rest_frame(const Part& part, const std::vector<Material<double>>& points, const Nodes& X);
/// The same of the spectral nodes.
MatX<double> rest_frame(const Part& part, const ModalBasis& basis);

/// An orthonormal basis of the columns of A, whatever their lengths. dependent: columns that are so small a
/// part away from the others, of their length, count for nothing.
MatX<double> orthonormal_basis(MatX<double> A, double dependent);

/// B and omega2 of a basis whose fields all carry the same mass and span the constant and X: all modes of the
/// stiffness K (3N x 3N, N/m) under W^T d = 0.
void diagonalise(const Part& part, const MatX<double>& K, ModalBasis& basis);

}  // namespace pliant
