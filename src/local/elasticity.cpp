#include <pliant/local/elasticity.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace pliant {

Elasticity::Elasticity(double E, double nu_P) : E_(E), nu_P_(nu_P) {
  std::ostringstream text;
  if (!(E > 0) || !std::isfinite(E))
    text << "Young's modulus " << E << " is not a positive number";
  else if (nu_P == 0.5)
    text << "Poisson's ratio 0.5 makes the material incompressible, which elements of displacement cannot "
            "be; take 0.4999 and averaged dilatation";
  else if (!(nu_P > -1) || !(nu_P < 0.5))
    text << "Poisson's ratio " << nu_P << " must be above -1 and below 0.5";
  if (!text.str().empty()) throw std::invalid_argument(text.str());
}

}  // namespace pliant
