// Drives: springs, dampers, servos and motors that act on a coordinate of a joint or on a parameter of a
// part.
//   F = k (target - x) + c (target_rate - x_dot) + force,   |F| <= max_force
// Here x is the coordinate. For the angle of a hinge and for a twist, multiples of 2 pi are removed from
// target - x, so that the difference is in [-pi, pi].
#pragma once

#include <limits>
#include <optional>
#include <string>

#include <pliant/body/actuation/state_function.h>

namespace pliant {

struct Drive {
  std::string name;
  Signal on;             ///< the coordinate x: of kind coordinate or parameter
  bool angle = false;    ///< whether x is the angle of a hinge, or a twist
  StateFunction target;  ///< m or rad
  /// Target of the rate, m/s or rad/s. Default: the time derivative of `target` if `target` is a function of
  /// time only, else 0.
  std::optional<StateFunction> target_rate;
  StateFunction stiffness;                                     ///< k, N/m or N m
  StateFunction damping;                                       ///< c, N s/m or N m s
  StateFunction force;                                         ///< N or N m
  double max_force = std::numeric_limits<double>::infinity();  ///< N or N m

  /// Returns whether the force can differ from 0 at time t, s. The force is 0 if stiffness, damping and
  /// `force` are functions of time with the value 0 at t.
  bool may_exert_force(double t) const {
    const auto is_zero = [t](const StateFunction& x) {
      return !x.reads_state() && x.of_time().value(t) == 0;
    };
    return !(is_zero(stiffness) && is_zero(damping) && is_zero(force));
  }

  /// Whether the drive is a spring and damper with constants. If such a drive acts at all times, the ledger
  /// has its energy k (x - target)^2 / 2. Otherwise the ledger has the work of F as actuation.
  bool is_passive() const {
    return target.is_constant() && !target_rate && stiffness.is_constant() && damping.is_constant() &&
           force.is_constant() && force.constant() == 0 &&
           !(max_force < std::numeric_limits<double>::infinity());
  }
};

}  // namespace pliant
