#include <pliant/part/quadrature/mass_distribution.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

#include <pliant/part/part.h>

namespace pliant {

Eigen::VectorXd mass_multiples(const Part& part, const MassDistribution& distribution,
                               const std::vector<Material<double>>& at) {
  Eigen::VectorXd multiples = distribution(at, part.s(at, part.parameters().rest()));
  for (Eigen::Index k = 0; k < multiples.size(); ++k) {
    if (multiples[k] >= 0 && std::isfinite(multiples[k])) continue;
    const MaterialAngles place = angles(at[static_cast<std::size_t>(k)]);
    std::ostringstream message;
    message << "part '" << part.name() << "': its mass distribution is " << multiples[k]
            << " at u = " << place.u << ", v = " << place.v << ", w = " << place.w
            << "; expected a number that is not negative";
    throw std::invalid_argument(message.str());
  }
  return multiples;
}

}  // namespace pliant
