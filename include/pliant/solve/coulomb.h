// Coulomb's law at one contact: what push p = (p_n, p_t) meets the velocity u = W p + b there,
//   0 <= p_n  _|_  u_n >= 0,   |p_t| <= mu p_n,   and p_t against u_t with |p_t| = mu p_n where it slides.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// W: of full rank, symmetric positive definite; rows: normal, then the two tangents. Exact but for rounding:
/// it lifts off, sticks, or slides, the rate of sliding found as the root of one equation.
Vec3<double> solve_coulomb(const Mat3<double>& W, const Vec3<double>& b, double mu);

}  // namespace pliant
