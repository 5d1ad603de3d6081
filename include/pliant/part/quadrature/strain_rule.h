// Quadrature points of the rest body for its strain energy (part/continuum.h).
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Returns the points. If the strain is equal everywhere in the body of a solid, one point suffices. Else the
/// rule has rings of points. The search doubles the nodes along each direction until energy, force, stiffness
/// and volume change by no more than kStrainTolerance at states spread over the ranges of the dynamic
/// parameters. Then it removes points that these integrals do not need. volume: volume of a solid at rest,
/// m^3; not used for a shell. Throws std::invalid_argument if no rule reaches a change of 100
/// kStrainTolerance, or if more than 2 million points are needed.
StrainPoints place_strain_points(const Part& part, const ContinuumLaw& law, double volume);

}  // namespace pliant
