// Function bodies of free_oscillation.h. The matrix exponential of one oscillator is
//   exp(A t) = [c + g s, s; -omega^2 s, c - g s],   A = [0, 1; -omega^2, -D],   g = D / 2.
#pragma once

#include <pliant/method/free_oscillation.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <pliant/math/header_only.h>
#include <pliant/math/scalar/functions.h>

namespace pliant {

namespace free_oscillation {

/// The functions c and s of exp(A t): with kappa = sqrt(omega^2 - g^2), c = e^(-g t) cos(kappa t) and s =
/// e^(-g t) sin(kappa t) / kappa. For overdamped motion (g > omega), kappa = sqrt(g^2 - omega^2), and cosh
/// and sinh replace cos and sin.
struct DampedCosSin {
  double c, s;
};
/// Returns c and s after t (s). omega2: omega^2, 1/s^2. g: half the damping D, 1/s.
inline DampedCosSin damped_cos_sin(double omega2, double g, double t) {
  const double squared = omega2 - g * g;
  if (squared > 0) {
    const double kappa = std::sqrt(squared), decay = math::exp(-g * t);
    const math::SinCos<double> angle = math::sin_cos(kappa * t);
    return {decay * angle.cos, decay * angle.sin / kappa};
  }
  // Overdamped: the decay rates are g - k and g + k. g - k is computed as omega^2 / (g + k), without
  // cancellation.
  const double k = std::sqrt(-squared), slow = g + k > 0 ? omega2 / (g + k) : 0;
  const double decay = math::exp(-slow * t), loss = -std::expm1(-2 * k * t);
  return {decay * (1 - 0.5 * loss), k * t != 0 ? decay * loss / (2 * k) : decay * t};
}

/// Returns the integral of exp(-rate t) from 0 to t, (1 - exp(-rate t)) / rate.
inline double integral_of_decay(double rate, double t) {
  return rate == 0 ? t : -std::expm1(-rate * t) / rate;
}

/// Returns the integral of s from 0 to t. end: c and s at t. The closed form (1 - c - g s) / omega^2 loses
/// digits for short t.
inline double integral_of_s(double omega2, double g, double t, const DampedCosSin& end) {
  constexpr double kShort = 0.5;
  if (std::sqrt(omega2) * std::abs(t) > kShort) return (1 - end.c - g * end.s) / omega2;
  const double k = std::sqrt(std::max(0.0, g * g - omega2));
  if (2 * k * std::abs(t) > kShort)
    return (integral_of_decay(omega2 / (g + k), t) - integral_of_decay(g + k, t)) / (2 * k);
  // Gauss quadrature with five points.
  constexpr std::array<double, 5> x{0.04691007703066800, 0.2307653449471585, 0.5, 0.7692346550528415,
                                    0.9530899229693320},
      w{0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832, 0.1184634425280945};
  double sum = 0;
  for (std::size_t n = 0; n < x.size(); ++n) sum += w[n] * damped_cos_sin(omega2, g, x[n] * t).s;
  return t * sum;
}

}  // namespace free_oscillation

PLIANT_INLINE OscillatorPropagator propagator(const Oscillators& oscillators, double t) {
  const Eigen::Index n = oscillators.omega2.size();
  OscillatorPropagator result;
  for (VecX<double>* entries : {&result.qq, &result.qv, &result.vq, &result.vv, &result.qn})
    entries->resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double omega2 = oscillators.omega2[j], g = 0.5 * oscillators.damping[j];
    const free_oscillation::DampedCosSin end = free_oscillation::damped_cos_sin(omega2, g, t);
    result.qq[j] = end.c + g * end.s;
    result.qv[j] = end.s;
    result.vq[j] = -omega2 * end.s;
    result.vv[j] = end.c - g * end.s;
    result.qn[j] = free_oscillation::integral_of_s(omega2, g, t, end);
  }
  return result;
}

PLIANT_INLINE VelocityResponse velocity_response(const Oscillators& oscillators, double t) {
  const Eigen::Index n = oscillators.omega2.size();
  VelocityResponse response{VecX<double>(n), VecX<double>(n)};
  for (Eigen::Index j = 0; j < n; ++j) {
    const double g = 0.5 * oscillators.damping[j];
    const free_oscillation::DampedCosSin end = free_oscillation::damped_cos_sin(oscillators.omega2[j], g, t);
    response.qv[j] = end.s;
    response.vv[j] = end.c - g * end.s;
  }
  return response;
}

PLIANT_INLINE bool oscillates_freely(const PartModel& part) {
  return part.local != nullptr && part.local->oscillators() != nullptr && part.joint_points.empty();
}

}  // namespace pliant
