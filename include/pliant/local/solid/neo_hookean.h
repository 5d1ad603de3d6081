// Neo-Hookean material of Smith, De Goes & Kim (2018) without their logarithmic term. Without this term, an
// element that has collapsed to a point is in stable equilibrium. With F = dx/dX, J = det F and the cofactors
// C = dJ/dF of F,
//   W = mu/2 (F:F - 3) - mu (J - 1) + (lambda + mu)/2 (J - 1)^2
//   P = mu F + ((lambda + mu)(J - 1) - mu) C.
// For small strains the law is Hooke's law with constants lambda and mu. W is a polynomial in F. It is
// therefore defined for inverted elements, and the forces turn such elements back.
#pragma once

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/tensor.h>

namespace pliant {

struct NeoHookean {
  static constexpr NodalEnergy::Of of = NodalEnergy::Of::position;
  static constexpr bool constant = false;
  double lambda, mu;

  explicit NeoHookean(const Elasticity& material) : lambda(material.lambda()), mu(material.mu()) {}

  template <class T>
  T density(const Mat3<T>& F) const {
    const T J_1 = determinant(F, cofactors(F)) - T(1);
    return T(mu / 2) * (contraction(F, F) - T(3)) + J_1 * (T((lambda + mu) / 2) * J_1 - T(mu));
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& F) const {
    const Mat3<T> C = cofactors(F);
    const T p = pressure(F, C);
    Mat3<T> P;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P(i, j) = T(mu) * F(i, j) + p * C(i, j);
    return P;
  }
  template <class T>
  Mat3<T> stress_along(const Mat3<T>& F, const Mat3<T>& dF) const {
    const Mat3<T> C = cofactors(F), dC = mixed_cofactors(F, dF);
    const T p = pressure(F, C), dp = T(lambda + mu) * contraction(C, dF);
    Mat3<T> dP;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) dP(i, j) = T(mu) * dF(i, j) + dp * C(i, j) + p * dC(i, j);
    return dP;
  }

 private:
  /// Returns the factor of C in P.
  template <class T>
  T pressure(const Mat3<T>& F, const Mat3<T>& C) const {
    return T(lambda + mu) * (determinant(F, C) - T(1)) - T(mu);
  }
};

}  // namespace pliant
