// Linear elasticity. With the displacement gradient H = dd/dX and eps = (H + H^T)/2,
//   W = lambda/2 (tr eps)^2 + mu eps:eps,   P = lambda tr(eps) I + 2 mu eps.
// W: energy for each unit of rest volume, J/m^3. P: stress, Pa.
#pragma once

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/tensor.h>

namespace pliant {

/// Every material law of this folder and of local/solid has these members. `of`: argument of the energy.
/// `constant`: whether the derivative of P is constant. lambda, mu: Lame's constants (Pa), which viscous
/// damping uses. density() returns W. stress() returns P = dW/dH, or dW/dF for large deformation.
/// stress_along() returns the derivative of P along dH or dF. T: double, Pack or a dual number.
struct LinearLaw {
  static constexpr NodalEnergy::Of of = NodalEnergy::Of::displacement;
  static constexpr bool constant = true;
  double lambda, mu;

  explicit LinearLaw(const Elasticity& material) : lambda(material.lambda()), mu(material.mu()) {}
  LinearLaw(double lambda_, double mu_) : lambda(lambda_), mu(mu_) {}

  template <class T>
  T density(const Mat3<T>& H) const {
    return contraction(stress(H), H) * T(0.5);
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& H) const {
    const T pressure = T(lambda) * trace(H);
    Mat3<T> P;
    for (int i = 0; i < 3; ++i) {
      P(i, i) = pressure + T(2 * mu) * H(i, i);
      const int j = (i + 1) % 3;
      P(i, j) = P(j, i) = T(mu) * (H(i, j) + H(j, i));
    }
    return P;
  }
  template <class T>
  Mat3<T> stress_along(const Mat3<T>&, const Mat3<T>& dH) const {
    return stress(dH);
  }
};

}  // namespace pliant
