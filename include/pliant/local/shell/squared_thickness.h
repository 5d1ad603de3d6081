// The squared stretch s of the thickness of a rubber sheet in plane stress, as a function of D = det C, the
// squared stretch of its area. The energy V(D) has V' = -s/D and V(1) = 0 (membrane_laws.h).
//   Blatz & Ko      s = D^-k,  V = (D^-k - 1)/k,  k = nu/(1 - nu);  for k -> 0  V = -log D
//   with ln J       nu ln(D s) + (1 - 2 nu)(s - 1) = 0,  V = (s - 1) - (s + 1) ln J,  ln J = ln(D s)/2
// The solid has the energy mu/2 (tr C + s - 3) - mu ln J + lambda/2 (ln J)^2. The equation of the law with ln
// J states that the derivative of this energy by s is zero; it is multiplied by 2 s (1 - 2 nu)/mu. The
// equation has one solution for 0 <= nu <= 1/2. For small strains both laws have s = 1 - k (D - 1).
#pragma once

#include <sstream>
#include <stdexcept>

#include <pliant/local/solid/inverted_element.h>
#include <pliant/local/tensor.h>

namespace pliant {

/// Members: share() returns s/D for a Pack or a dual number D; energy() returns V.
struct BlatzKoThickness {
  static constexpr const char* name = "neo_hookean";
  double k;

  explicit BlatzKoThickness(double nu) : k(nu / (1 - nu)) {}
  template <class T>
  T share(const T& D) const {
    if (k == 1) return 1.0 / (D * D);
    if (k == 0) return 1.0 / D;
    return math::exp(T(-(k + 1) * math::log(D)));
  }
  Pack energy(const Pack& D) const { return k == 0 ? -log(D) : (D * share(D) - 1.0) / k; }
};

/// See BlatzKoThickness for the members. The functions throw InvertedElement for a triangle without area.
struct LogThickness {
  static constexpr const char* name = "neo_hookean_log";
  double nu;

  /// Throws std::invalid_argument for a negative nu.
  explicit LogThickness(double nu_P) : nu(nu_P) {
    if (nu < 0)
      throw std::invalid_argument(
          "the law neo_hookean_log_membrane has no lowest energy for a negative Poisson's ratio; expected nu "
          "from 0 to 0.5");
  }
  Pack share(const Pack& D) const { return exp(log_squared(D)) / D; }
  template <int N>
  Dual<N, Pack> share(const Dual<N, Pack>& D) const {
    const Pack s = exp(log_squared(D.v)), value = s / D.v;
    return chain_rule(D, value, Pack(-value / D.v * (1.0 + nu / (nu + (1 - 2 * nu) * s))));
  }
  Pack energy(const Pack& D) const {
    const Pack log_s = log_squared(D), s = exp(log_s);
    return (s - 1.0) - (s + 1.0) * (0.5 * (log(D) + log_s));
  }

 private:
  /// Returns ln s by Newton's method, which starts from s of Blatz & Ko. The function is convex and
  /// increasing in ln s, so that all iterates after the first are above the solution and decrease.
  Pack log_squared(const Pack& D) const {
    if (!(min_lane(D) > 0)) {
      std::ostringstream text;
      text << "a triangle with the law neo_hookean_log_membrane has no area (det C = " << min_lane(D)
           << "), where the energy of this law is infinite";
      throw InvertedElement(text.str());
    }
    constexpr int max_iterations = 100;
    constexpr double rounding = 4e-16;
    const Pack log_D = log(D);
    Pack y = -nu / (1 - nu) * log_D;
    for (int i = 0; i < max_iterations; ++i) {
      const Pack s = exp(y);
      const Pack change = (nu * (y + log_D) + (1 - 2 * nu) * (s - 1.0)) / (nu + (1 - 2 * nu) * s);
      y = y - change;
      if (min_lane(rounding * (1.0 + math::abs(y)) - math::abs(change)) >= 0) break;
    }
    return y;
  }
};

}  // namespace pliant
