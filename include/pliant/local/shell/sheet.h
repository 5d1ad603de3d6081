// A thin isotropic elastic sheet in plane stress. E: Young's modulus (Pa), nu: Poisson's ratio, t: thickness
// (m).
//   stretch   W(e) = t/2 [lambda (tr e)^2 + 2 mu e:e],   lambda = E nu/(1 - nu^2),   2 mu = E/(1 + nu)
//   bending   W(k) = D/2 [nu (tr k)^2 + (1 - nu) k:k],   D = E t^3/(12 (1 - nu^2))
// W: energy for each unit of rest area, J/m^2; e: in-plane strain; k: curvature, 1/m.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

struct Sheet {
  double E;          ///< Pa
  double nu;         ///< Poisson's ratio
  double thickness;  ///< m

  /// Throws std::invalid_argument, with the value, unless E is finite and >= 0, -1 < nu <= 1/2, and thickness
  /// is finite and > 0.
  void check() const;
  /// Lame's constants of plane stress, Pa.
  double lambda() const { return E * nu / (1 - nu * nu); }
  double mu() const { return E / (2 * (1 + nu)); }
  /// Returns D, N m.
  double bending_stiffness() const { return E * thickness * thickness * thickness / (12 * (1 - nu * nu)); }
};

}  // namespace pliant
