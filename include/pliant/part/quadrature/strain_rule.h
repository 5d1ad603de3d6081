// Quadrature points of the rest body for its strain energy (part/continuum.h).
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Places the points. If all points of the body have equal strains, one point suffices. Else the rule has
/// rings of points, which are doubled until energy, force and stiffness change by no more than kStrainSettled
/// at states spread over the ranges of the dynamic parameters, and then thinned. volume: of the body at rest,
/// m^3. Throws std::invalid_argument if the search does not converge.
StrainPoints place_strain_points(const Part& part, const ContinuumLaw& law, double volume);

}  // namespace pliant
