// What a basis must leave out, and the modes of what is left.
#pragma once

#include <pliant/part/modal_basis.h>

namespace pliant {

/// G0 = [I, -[X]x, J] of the spectral nodes at the rest shape: 3N x (6 + n_s).
MatX<double> rest_frame(const Part& part, const ModalBasis& basis);

/// B and omega2 of a basis whose fields all carry the same mass and span the constant and X: all modes of the
/// stiffness K (3N x 3N, N/m) under W^T d = 0.
void diagonalise(const Part& part, const MatX<double>& K, ModalBasis& basis);

}  // namespace pliant
