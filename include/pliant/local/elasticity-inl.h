// Check of the constants of an isotropic material.
#pragma once

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <pliant/local/elasticity.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE Elasticity::Elasticity(double E, double nu_P) : E_(E), nu_P_(nu_P) {
  std::ostringstream text;
  if (!(E > 0) || !std::isfinite(E))
    text << "Young's modulus is " << E << " Pa; it must be positive and finite";
  else if (nu_P == 0.5)
    text << "Poisson's ratio is 0.5, an incompressible material, which displacement elements cannot "
            "represent; "
            "use 0.4999 and averaged dilatation";
  else if (!(nu_P > -1) || !(nu_P < 0.5))
    text << "Poisson's ratio is " << nu_P << "; it must be above -1 and below 0.5";
  if (!text.str().empty()) throw std::invalid_argument(text.str());
}

}  // namespace pliant
