// The sums of Eq. (11) over given mass points, for the choice and the check of mass points and for the
// inertia at rest.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Computes mass matrix and inertial forces of a part over the given points instead of the mass points of the
/// part. The other arguments are those of Part::evaluate_inertia().
void sum_inertia(const Part& part, const MassPoints& points, const VecMax<double>& q_s,
                 const VecMax<double>& q_s_dot, const Vec3<double>& omega, Inertia<double>& out,
                 Counters& counters);
/// Returns the moments, summed over the given mass points, of a part whose s is linear in q_s
/// (Part::linear()).
LinearInertia make_linear_inertia(const Part& part, const MassPoints& points);

}  // namespace pliant
