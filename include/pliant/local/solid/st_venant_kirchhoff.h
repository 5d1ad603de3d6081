// St. Venant-Kirchhoff material. From F = dx/dX, with Green's strain G = (F^T F - I)/2,
//   W = lambda/2 (tr G)^2 + mu G:G,   S = lambda tr(G) I + 2 mu G,   P = F S.
// The law is valid for large rotations and small strains. The material softens under strong compression, and
// an inverted element can be in equilibrium without loads.
#pragma once

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/solid/hooke.h>

namespace pliant {

struct StVenantKirchhoff {
  static constexpr NodalEnergy::Of of = NodalEnergy::Of::position;
  static constexpr bool constant = false;
  double lambda, mu;

  explicit StVenantKirchhoff(const Elasticity& material) : lambda(material.lambda()), mu(material.mu()) {}

  template <class T>
  T density(const Mat3<T>& F) const {
    const Mat3<T> G = green_strain(F);
    return contraction(hooke_stress(lambda, mu, G), G) * T(0.5);
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& F) const {
    return product(F, hooke_stress(lambda, mu, green_strain(F)));
  }
  template <class T>
  Mat3<T> stress_along(const Mat3<T>& F, const Mat3<T>& dF) const {
    return product(dF, hooke_stress(lambda, mu, green_strain(F))) + viscous_stress(lambda, mu, F, dF);
  }
};

}  // namespace pliant
