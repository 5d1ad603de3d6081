// Green's strain, Hooke's law of an isotropic material and Kelvin-Voigt damping, from F = dx/dX:
//   G = (F^T F - I)/2,   Gdot = (F^T Fdot + Fdot^T F)/2,   S(G) = lambda tr(G) I + 2 mu G
//   P_v = F S(Gdot)   viscous stress for beta = 1 s
// At rest, F = I, every isotropic law with these constants has dP = S(eps) for a small strain eps. At rest
// the force by P_v is therefore -K x_dot with the stiffness K of the law. Rigid motion has Gdot = 0. The
// dissipated power P_v : Fdot = S(Gdot) : Gdot is never negative.
//
// Functions that contain I have a parameter Dim. Dim = 3 is for solids. Dim = 2 is for surfaces: F has two
// non-zero columns, and I has two ones on its diagonal.
#pragma once

#include <pliant/local/tensor.h>

namespace pliant {

/// Returns G.
template <int Dim = 3, class T>
Mat3<T> green_strain(const Mat3<T>& F) {
  Mat3<T> G = scaled(T(0.5), transposed_product(F, F));
  for (int i = 0; i < Dim; ++i) G(i, i) -= T(0.5);
  return G;
}
/// Returns Gdot, 1/s.
template <class T>
Mat3<T> green_strain_rate(const Mat3<T>& F, const Mat3<T>& F_dot) {
  const Mat3<T> A = transposed_product(F, F_dot);
  Mat3<T> G_dot;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) G_dot(i, j) = T(0.5) * (A(i, j) + A(j, i));
  return G_dot;
}
/// Returns S(G), Pa.
template <int Dim = 3, class T>
Mat3<T> hooke_stress(double lambda, double mu, const Mat3<T>& G) {
  Mat3<T> S = scaled(T(2 * mu), G);
  const T pressure = T(lambda) * trace(G);
  for (int i = 0; i < Dim; ++i) S(i, i) += pressure;
  return S;
}
/// Returns P_v, Pa/s. beta (s) times P_v is a stress.
template <int Dim = 3, class T>
Mat3<T> viscous_stress(double lambda, double mu, const Mat3<T>& F, const Mat3<T>& F_dot) {
  return product(F, hooke_stress<Dim>(lambda, mu, green_strain_rate(F, F_dot)));
}

}  // namespace pliant
