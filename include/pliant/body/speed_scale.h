// Scales that compare velocities of different units: m/s, rad/s, and rates of parameters.
#pragma once

#include <algorithm>
#include <cmath>

#include <pliant/body/model.h>

namespace pliant {

/// Returns the factor (m or 1) that converts velocity k of v_r of a part, k < 6 + n_s, to a speed, m/s: 1 for
/// c_dot and for rates of lengths, the size of the part for omega and for rates of other parameters.
inline double lever(const PartModel& m, int k) {
  if (k < 3) return 1;
  if (k < 6 || m.part->parameters().moving(k - 6).spec->quantity != Quantity::length) return m.size;
  return 1;
}

/// Returns the factors that convert the local coordinates of a part to lengths, m: 1 for nodes, and the size
/// of the part for the angles that a bending energy of a shell adds. Amplitudes of modes have the unit
/// m kg^(1/2); their factor is 1 / sqrt(mass of the part).
inline VecX<double> local_levers(const PartModel& m) {
  if (m.local->oscillators() != nullptr)
    return VecX<double>::Constant(m.n_d(), 1 / std::sqrt(m.part->total_mass()));
  VecX<double> levers = VecX<double>::Constant(m.n_d(), m.size);
  levers.head(3 * m.local->mesh().X.rows()).setOnes();
  return levers;
}

/// Returns the largest entry of v, as a speed, m/s. v: the first 6 + n_s velocities of a part.
template <class V>
double largest_speed(const PartModel& m, const V& v) {
  double largest = std::max(v.template head<3>().template lpNorm<Eigen::Infinity>(),
                            m.size * v.template segment<3>(3).template lpNorm<Eigen::Infinity>());
  for (int k = 6; k < 6 + m.n_s; ++k) largest = std::max(largest, lever(m, k) * std::abs(v[k]));
  return largest;
}

/// Estimates the largest speed that the rates of the parameters give a point of a part, relative to the frame
/// of the part, m/s. v: the first 6 + n_s velocities of the part. reach: largest distance of a point from the
/// origin, m.
template <class V>
double shape_speed(const PartModel& m, const V& v, double reach) {
  double speed = 0;
  for (int k = 6; k < 6 + m.n_s; ++k) speed += lever(m, k) * std::abs(v[k]);
  return m.n_s == 0 ? 0 : reach / m.size * speed;
}

/// Returns the rate (1/s) up to which a motion is slow: a tenth of Stabilization::rate, by default 1 per
/// second. This rate is the unit in formulas that need a scale of time and have no other.
inline double slow_rate(const Model& model) {
  return 0.1 * model.body().stabilization.rate;
}

}  // namespace pliant
