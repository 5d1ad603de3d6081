// A quadrature over the body of a solid at rest for polynomials of the coordinates. The number of nodes along
// each material direction is increased until no integral of a polynomial changes. The rule is then exact to
// rounding for most shapes.
#pragma once

#include <vector>

#include <pliant/part/part.h>

#include "legendre.h"

namespace pliant {

struct BodyRule {
  std::vector<Material<double>> at;  ///< the points
  Eigen::Matrix3Xd X;                ///< positions of the points at rest, body frame, m
  VecX<double> volume;               ///< the weights, m^3
  double remaining_change = 0;       ///< change of the integrals by refinement, relative to the
                                     ///< volume; 0 if converged
};

/// Returns a rule for the integrals of all given products of Legendre polynomials. The rule may not have
/// converged; see remaining_change. Throws std::invalid_argument for more than two million points.
BodyRule make_body_rule(const Part& part, const LegendreProducts& polynomials);

}  // namespace pliant
