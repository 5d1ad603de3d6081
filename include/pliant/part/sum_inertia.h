// The sum of Eq. (11) over given mass points, for choosing and judging them, or once for all.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Mass matrix and inertial forces of a part over the given points instead of its own.
void sum_inertia(const Part& part, const MassPoints& points, const VecMax<double>& q_s,
                 const VecMax<double>& q_s_dot, const Vec3<double>& omega, Inertia<double>& out,
                 Counters& counters);
/// The moments of a linear part over its mass points.
LinearInertia make_linear_inertia(const Part& part, const MassPoints& points);

}  // namespace pliant
