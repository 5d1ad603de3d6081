// A quadrature over the body of a solid at rest for polynomials of the coordinates. Nodes along each material
// direction are refined until no moment changes, so that the rule is exact to rounding for most shapes.
#pragma once

#include <vector>

#include <pliant/part/part.h>

#include "legendre.h"

namespace pliant {

struct BodyRule {
  std::vector<Material<double>> at;  ///< the points
  Eigen::Matrix3Xd X;                ///< positions of the points at rest, body frame, m
  VecX<double> volume;               ///< the weights, m^3
  double remaining_change = 0;  ///< largest change of a moment by refining, over the volume; 0 if converged
};

/// Makes a rule for the integrals of all given products of Legendre polynomials. Throws std::invalid_argument
/// if it needs more than two million points.
BodyRule make_body_rule(const Part& part, const LegendreProducts& polynomials);

}  // namespace pliant
