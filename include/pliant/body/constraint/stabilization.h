// How open joints close, and how closed ones are kept so (design 1.5): Baumgarte's
//   C_ddot + 2 alpha C_dot + beta^2 C = 0
// with a cap on the speed at which it closes a gap, and projection of coordinates and velocities after a
// step.
#pragma once

#include <cmath>
#include <optional>
#include <stdexcept>

namespace pliant {

/// Where alpha and beta come from.
enum class BaumgarteRule {
  automatic,        ///< step_consistent for semi-implicit Euler, critical for all others
  free,             ///< stab_alpha and stab_beta as given, the latter > 0: without it no gap closes
  critical,         ///< alpha = beta = rate: C decays as (1 + rate t) e^(-rate t) from rest
  step_consistent,  ///< with r = e^(-rate h): beta = (1 - r) / h, alpha = (1 - r^2) / (2 h)
};

struct Gains {
  double alpha = 0, beta = 0;  ///< 1/s
  bool operator==(const Gains& other) const { return alpha == other.alpha && beta == other.beta; }
};

struct Stabilization {
  BaumgarteRule rule = BaumgarteRule::automatic;
  double rate = 10;                      ///< decay rate of a gap, 1/s
  double stab_alpha = 0, stab_beta = 0;  ///< of the rule `free`, 1/s
  /// Most speed at which a gap is closed, in units of rate times the length of the smaller part.
  double speed = 3;
  /// Whether open joints are brought together before time 0 (integrate/assemble.h), not while time runs.
  bool assemble_first = false;
  /// Whether closed joints are projected after each step; by default they are.
  std::optional<bool> projection;

  /// Throws std::invalid_argument unless every number is finite and not negative, and the rate is positive,
  /// and stab_beta where it is of use.
  void check() const {
    if (!(rate > 0) || !std::isfinite(rate))
      throw std::invalid_argument("stabilization: rate must be a number > 0");
    for (const double number : {stab_alpha, stab_beta, speed})
      if (!(number >= 0) || !std::isfinite(number))
        throw std::invalid_argument("stabilization: stab_alpha, stab_beta and speed must be numbers >= 0");
    if (rule == BaumgarteRule::free && stab_beta == 0)
      throw std::invalid_argument("stabilization: the rule free needs stab_beta > 0; no gap closes without");
  }
  /// Whether the gains go with the step, so that any step is stable; consistent: what automatic means.
  bool follows_step(bool consistent) const {
    return rule == BaumgarteRule::step_consistent || (rule == BaumgarteRule::automatic && consistent);
  }
  /// h: step, s.
  Gains gains(double h, bool consistent) const {
    if (rule == BaumgarteRule::free) return {stab_alpha, stab_beta};
    if (!follows_step(consistent) || !(h > 0)) return {rate, rate};  // the latter the limit of small steps
    const double r = std::exp(-rate * h);
    return {(1 - r * r) / (2 * h), (1 - r) / h};
  }
};

}  // namespace pliant
