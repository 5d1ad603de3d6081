// Settings of the constraint stabilisation of section 4 of the paper: Baumgarte's equation
//   C_ddot + 2 alpha C_dot + beta^2 C = 0
// with a largest speed at which a gap closes, and projection of coordinates and velocities after a step.
// constraints-inl.h computes Baumgarte's terms.
#pragma once

#include <cmath>
#include <optional>
#include <stdexcept>

namespace pliant {

/// The rule that chooses alpha and beta.
enum class BaumgarteRule {
  automatic,        ///< step_consistent for semi-implicit Euler, critical for all other methods
  free,             ///< alpha = stab_alpha, beta = stab_beta; stab_beta = 0 is an error: no gap would close
  critical,         ///< alpha = beta = rate: from rest C decays as (1 + rate t) e^(-rate t)
  step_consistent,  ///< r = e^(-rate h), beta = (1 - r) / h, alpha = (1 - r^2) / (2 h): with
                    ///< semi-implicit Euler, both roots of the discrete equation are r
};

/// The gains of Baumgarte's equation.
struct Gains {
  double alpha = 0, beta = 0;  ///< 1/s
  bool operator==(const Gains& other) const { return alpha == other.alpha && beta == other.beta; }
};

struct Stabilization {
  BaumgarteRule rule = BaumgarteRule::automatic;
  double rate = 10;                      ///< decay rate of a gap, 1/s
  double stab_alpha = 0, stab_beta = 0;  ///< gains of the rule `free`, 1/s
  /// Largest speed at which the gap of a closing joint closes, in units of `rate` times the size of the
  /// smaller part.
  double speed = 3;
  /// Whether open joints are closed before time 0 (project/assemble.h), not during the run.
  bool assemble_first = false;
  /// Whether closed joints are projected after each step; the default is true.
  std::optional<bool> projection;

  /// Throws std::invalid_argument unless all numbers are finite and not negative, the rate is positive, and
  /// stab_beta is positive for the rule `free`.
  void check() const {
    if (!(rate > 0) || !std::isfinite(rate))
      throw std::invalid_argument("stabilization: rate must be a number > 0");
    for (const double number : {stab_alpha, stab_beta, speed})
      if (!(number >= 0) || !std::isfinite(number))
        throw std::invalid_argument("stabilization: stab_alpha, stab_beta and speed must be numbers >= 0");
    if (rule == BaumgarteRule::free && stab_beta == 0)
      throw std::invalid_argument("stabilization: the rule free needs stab_beta > 0, or no gap closes");
  }
  /// Returns whether the gains depend on the step length. consistent: whether the rule `automatic` means
  /// `step_consistent`.
  bool follows_step(bool consistent) const {
    return rule == BaumgarteRule::step_consistent || (rule == BaumgarteRule::automatic && consistent);
  }
  /// Returns the gains for a step of length h (s). consistent: as for follows_step().
  Gains gains(double h, bool consistent) const {
    if (rule == BaumgarteRule::free) return {stab_alpha, stab_beta};
    // For h -> 0, the gains of the rule step_consistent tend to the gains of the rule critical.
    if (!follows_step(consistent) || !(h > 0)) return {rate, rate};
    const double r = std::exp(-rate * h);
    return {(1 - r * r) / (2 * h), (1 - r) / h};
  }
};

}  // namespace pliant
