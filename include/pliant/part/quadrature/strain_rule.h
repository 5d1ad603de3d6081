// Quadrature points of the rest body for the strain energy of a part (part/continuum.h).
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Returns the quadrature points. If the strain is equal everywhere in the body of a solid, the result is one
/// point. Otherwise the rule has rings of points. The search increases the number of nodes along each
/// direction until doubling changes energy, force, stiffness and volume by at most kStrainTolerance, at
/// states spread over the ranges of the dynamic parameters. Then points that these integrals do not need are
/// removed. volume: volume of a solid at rest, m^3; ignored for a shell. Throws std::invalid_argument if the
/// change stays above 100 kStrainTolerance, or if more than 2 million points are needed.
StrainPoints place_strain_points(const Part& part, const ContinuumLaw& law, double volume);

}  // namespace pliant
