// Masses of given points that reproduce the moments of a part.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Changes masses so that they have the mass, the centre and the second moments of a part. The relative
/// changes are the smallest ones in the mean square over the mass. X: the points at rest, body frame, m, one
/// row each. Returns the largest remaining error of a moment, relative to the mass times the largest
/// coordinates in this moment.
double match_moments(const Inertia<double>& whole, const Nodes& X, VecX<double>& mass);

/// Remaining errors up to this are rounding errors.
inline constexpr double kMatched = 1e-10;

}  // namespace pliant
