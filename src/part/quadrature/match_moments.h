// Masses of given points that reproduce the moments of a part.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Changes masses so that they have the mass, the centre and the second moments of a part. The mean square of
/// the relative changes, weighted by mass, is as small as possible. X: the points at rest, body frame, m, one
/// row for each point. Returns the largest remaining error of a moment, relative to the mass times the
/// largest coordinates in this moment.
double match_moments(const Inertia<double>& whole, const Nodes& X, VecX<double>& mass);

/// Remaining errors up to this value are rounding errors.
inline constexpr double kMatched = 1e-10;

}  // namespace pliant
