// Hooke's law of a thin isotropic sheet (plane stress): E Young's modulus (Pa), nu Poisson's ratio,
//   W(e) = t/2 [lambda (tr e)^2 + 2 mu e:e] per area,  lambda = E nu/(1 - nu^2),  2 mu = E/(1 + nu);
// bent, with the curvature k:  W(k) = D/2 [nu (tr k)^2 + (1 - nu) k:k],  D = E t^3/(12 (1 - nu^2)).
#pragma once

#include <pliant/math/types.h>

namespace pliant {

struct Sheet {
  double E;          ///< Pa
  double nu;         ///< Poisson's ratio
  double thickness;  ///< m

  /// Throws std::invalid_argument, naming the value, unless E >= 0, -1 < nu <= 1/2 and thickness > 0.
  void check() const;
  double lambda() const { return E * nu / (1 - nu * nu); }
  double mu() const { return E / (2 * (1 + nu)); }
  /// D, N m.
  double bending_stiffness() const { return E * thickness * thickness * thickness / (12 * (1 - nu * nu)); }
};

}  // namespace pliant
