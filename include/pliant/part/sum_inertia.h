// The sums of Eq. (11) over given mass points. Part::prepare() computes the inertia at rest with these sums.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Computes the mass matrix and the inertial forces over the given points instead of the mass points of the
/// part. The other arguments are those of Part::evaluate_inertia().
void sum_inertia(const Part& part, const MassPoints& points, const VecMax<double>& q_s,
                 const VecMax<double>& q_s_dot, const Vec3<double>& omega, Inertia<double>& out,
                 Counters& counters);
/// Returns the moments over the given mass points of a part whose s is linear in q_s (Part::linear()).
LinearInertia make_linear_inertia(const Part& part, const MassPoints& points);

}  // namespace pliant
