// Points of the rest body for its strain energy.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Lays them: one where all points are strained alike, else rings that are doubled until energy, force and
/// stiffness change by no more than kStrainSettled at states spread over the ranges of the dynamic
/// parameters, then thinned. Throws std::invalid_argument where that never happens.
StrainPoints place_strain_points(const Part& part, const ContinuumLaw& law, double volume);

}  // namespace pliant
