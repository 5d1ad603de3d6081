// Bodies of free_oscillation.h.
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/method/free_oscillation.h>

#include <algorithm>
#include <array>
#include <cmath>

#include <pliant/math/scalar/functions.h>

namespace pliant {

namespace free_oscillation {

/// The functions c and s of exp(A t) = [c + g s, s; -omega^2 s, c - g s] with g = D/2, for a damped
/// oscillation or an overdamped decay.
struct Swing {
  double c, s;
};
inline Swing swing(double omega2, double g, double t) {
  const double squared = omega2 - g * g;
  if (squared > 0) {
    const double kappa = std::sqrt(squared), fade = math::exp(-g * t);
    const math::SinCos<double> of = math::sin_cos(kappa * t);
    return {fade * of.cos, fade * of.sin / kappa};
  }
  // Overdamped: two decay rates g - k and g + k.
  const double k = std::sqrt(-squared), slow = g + k > 0 ? omega2 / (g + k) : 0;
  const double fade = math::exp(-slow * t), faster = -std::expm1(-2 * k * t);
  return {fade * (1 - 0.5 * faster), k * t != 0 ? fade * faster / (2 * k) : fade * t};
}

/// Returns (1 - exp(-rate t)) / rate.
inline double decayed(double rate, double t) {
  return rate == 0 ? t : -std::expm1(-rate * t) / rate;
}

/// Returns the integral of s over t. The closed form (1 - c - g s) / omega^2 loses digits for short t.
inline double pushed(double omega2, double g, double t, const Swing& of) {
  constexpr double kShort = 0.5;
  if (std::sqrt(omega2) * std::abs(t) > kShort) return (1 - of.c - g * of.s) / omega2;
  const double k = std::sqrt(std::max(0.0, g * g - omega2));
  if (2 * k * std::abs(t) > kShort) return (decayed(omega2 / (g + k), t) - decayed(g + k, t)) / (2 * k);
  // Gauss quadrature with five points.
  constexpr std::array<double, 5> x{0.04691007703066800, 0.2307653449471585, 0.5, 0.7692346550528415,
                                    0.9530899229693320},
      w{0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832, 0.1184634425280945};
  double sum = 0;
  for (std::size_t n = 0; n < x.size(); ++n) sum += w[n] * swing(omega2, g, x[n] * t).s;
  return t * sum;
}

}  // namespace free_oscillation

PLIANT_INLINE OscillatorMoves moves_over(const Oscillators& oscillators, double t) {
  const Eigen::Index n = oscillators.omega2.size();
  OscillatorMoves moves;
  for (VecX<double>* numbers : {&moves.qq, &moves.qv, &moves.vq, &moves.vv, &moves.qn}) numbers->resize(n);
  for (Eigen::Index j = 0; j < n; ++j) {
    const double omega2 = oscillators.omega2[j], g = 0.5 * oscillators.damping[j];
    const free_oscillation::Swing of = free_oscillation::swing(omega2, g, t);
    moves.qq[j] = of.c + g * of.s;
    moves.qv[j] = of.s;
    moves.vq[j] = -omega2 * of.s;
    moves.vv[j] = of.c - g * of.s;
    moves.qn[j] = free_oscillation::pushed(omega2, g, t, of);
  }
  return moves;
}

PLIANT_INLINE OscillatorKicks kicks_over(const Oscillators& oscillators, double t) {
  const Eigen::Index n = oscillators.omega2.size();
  OscillatorKicks kicks{VecX<double>(n), VecX<double>(n)};
  for (Eigen::Index j = 0; j < n; ++j) {
    const double g = 0.5 * oscillators.damping[j];
    const free_oscillation::Swing of = free_oscillation::swing(oscillators.omega2[j], g, t);
    kicks.qv[j] = of.s;
    kicks.vv[j] = of.c - g * of.s;
  }
  return kicks;
}

PLIANT_INLINE bool oscillates_freely(const PartModel& part) {
  return part.local != nullptr && part.local->oscillators() != nullptr && part.shared.empty();
}

}  // namespace pliant
