// Function bodies of sheet.h.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>

#include <pliant/local/shell/sheet.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE void Sheet::check() const {
  if (!(E >= 0) || !std::isfinite(E))
    throw std::invalid_argument("Young's modulus is " + std::to_string(E) +
                                " Pa; it must be finite and not negative");
  if (!(nu > -1 && nu <= 0.5))
    throw std::invalid_argument("Poisson's ratio is " + std::to_string(nu) +
                                "; it must be above -1 and at most 0.5");
  if (!(thickness > 0) || !std::isfinite(thickness))
    throw std::invalid_argument("the thickness is " + std::to_string(thickness) +
                                " m; it must be positive and finite");
}

}  // namespace pliant
