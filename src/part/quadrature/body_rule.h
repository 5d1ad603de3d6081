// A quadrature over the body of a solid at rest, exact to rounding for polynomials of its coordinates where
// the shape lets it be: nodes along each material direction are refined until no moment changes.
#pragma once

#include <vector>

#include <pliant/part/part.h>

#include "legendre.h"

namespace pliant {

struct BodyRule {
  std::vector<Material<double>> at;
  Eigen::Matrix3Xd X;  ///< body frame, m
  VecX<double> volume;
  double unsettled = 0;  ///< largest change of a moment that refining still makes, relative to the volume
};

/// For all products of Legendre polynomials of a total degree. Throws std::invalid_argument when that takes
/// more than two million points.
BodyRule make_body_rule(const Part& part, const LegendreProducts& polynomials);

}  // namespace pliant
