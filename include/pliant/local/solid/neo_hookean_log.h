// Compressible neo-Hookean material with logarithms, the classical law of finite-element textbooks (Bonet &
// Wood 2008, section 6.4.3). With F = dx/dX, J = det F, I_C = F:F and the cofactors C = dJ/dF = J F^-T of F,
//   W = mu/2 (I_C - 3) - mu ln J + lambda/2 (ln J)^2
//   P = mu F + (lambda ln J - mu)/J C.
// For small strains the law is Hooke's law with constants lambda and mu. W grows without bound for J -> 0 and
// is not defined for J <= 0. For lambda < 0 (nu_P < 0) W has no lower bound, so that nu_P must be at least 0.
#pragma once

#include <sstream>
#include <stdexcept>

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/local/tensor.h>

namespace pliant {

struct NeoHookeanLog {
  static constexpr NodalEnergy::Of of = NodalEnergy::Of::position;
  static constexpr bool constant = false;
  double lambda, mu;

  /// Throws std::invalid_argument for a negative nu_P.
  explicit NeoHookeanLog(const Elasticity& material) : lambda(material.lambda()), mu(material.mu()) {
    if (lambda < 0)
      throw std::invalid_argument(
          "the law neo_hookean_log has no lowest energy for a negative Poisson's ratio; expected nu from 0 "
          "to "
          "below 0.5");
  }

  template <class T>
  T density(const Mat3<T>& F) const {
    const T log_J = log_of(determinant(F, cofactors(F)));
    return T(mu / 2) * (contraction(F, F) - T(3)) + log_J * (T(lambda / 2) * log_J - T(mu));
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& F) const {
    const Mat3<T> C = cofactors(F);
    const T J = determinant(F, C), p = pressure(J) / J;
    Mat3<T> P;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P(i, j) = T(mu) * F(i, j) + p * C(i, j);
    return P;
  }
  template <class T>
  Mat3<T> stress_along(const Mat3<T>& F, const Mat3<T>& dF) const {
    const Mat3<T> C = cofactors(F), dC = mixed_cofactors(F, dF);
    const T J = determinant(F, C), J_p = pressure(J), p = J_p / J;
    const T dp = (T(lambda) - J_p) * contraction(C, dF) / (J * J);
    Mat3<T> dP;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) dP(i, j) = T(mu) * dF(i, j) + dp * C(i, j) + p * dC(i, j);
    return dP;
  }

 private:
  /// Returns J times the factor of C in P.
  template <class T>
  T pressure(const T& J) const {
    return T(lambda) * log_of(J) - T(mu);
  }
  /// Returns ln J. Throws InvertedElement unless J > 0.
  template <class T>
  static T log_of(const T& J) {
    if (!(min_lane(J) > 0)) {
      std::ostringstream text;
      text << "an element with the law neo_hookean_log is inverted or flat (det F = " << min_lane(J)
           << "), where the energy of this law is infinite; the law neo_hookean allows inverted elements";
      throw InvertedElement(text.str());
    }
    return math::log(J);
  }
};

}  // namespace pliant
