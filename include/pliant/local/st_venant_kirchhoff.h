// St. Venant-Kirchhoff: of F = dx/dX, strain G = (F^T F - I)/2,
//   W = lambda/2 (tr G)^2 + mu G:G,   S = lambda tr(G) I + 2 mu G,   P = F S
// For large rotations, but small strains: it gives way under strong compression, and an element that is
// turned inside out may rest there.
#pragma once

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/tensor.h>

namespace pliant {

struct StVenantKirchhoff {
  static constexpr NodalEnergy::Of of = NodalEnergy::Of::position;
  static constexpr bool constant = false;
  double lambda, mu;

  explicit StVenantKirchhoff(const Elasticity& material) : lambda(material.lambda()), mu(material.mu()) {}

  template <class T>
  T density(const Mat3<T>& F) const {
    const Mat3<T> G = strain(F);
    return contraction(second_stress(G), G) * T(0.5);
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& F) const {
    return product(F, second_stress(strain(F)));
  }
  template <class T>
  Mat3<T> stress_along(const Mat3<T>& F, const Mat3<T>& dF) const {
    const Mat3<T> A = transposed_product(F, dF);
    Mat3<T> dG;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) dG(i, j) = T(0.5) * (A(i, j) + A(j, i));
    return product(dF, second_stress(strain(F))) + product(F, second_stress(dG));
  }

 private:
  template <class T>
  static Mat3<T> strain(const Mat3<T>& F) {
    Mat3<T> G = scaled(T(0.5), transposed_product(F, F));
    for (int i = 0; i < 3; ++i) G(i, i) -= T(0.5);
    return G;
  }
  template <class T>
  Mat3<T> second_stress(const Mat3<T>& G) const {
    Mat3<T> S = scaled(T(2 * mu), G);
    const T pressure = T(lambda) * trace(G);
    for (int i = 0; i < 3; ++i) S(i, i) += pressure;
    return S;
  }
};

}  // namespace pliant
