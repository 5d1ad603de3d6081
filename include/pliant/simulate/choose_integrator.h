// The choice of the method of integration for a model and a tolerance. If nothing is elastic or damped, the
// choice is an explicit method of high order. Otherwise each candidate integrates some steps from the start,
// and the one that advances farthest at equal cost is chosen. The cost is counted in evaluations of the
// accelerations by a fixed model, never by a clock.
#pragma once

#include <string>

#include <pliant/method/integrator.h>

namespace pliant {

/// The name that requests this choice, in place of the name of a method.
inline constexpr const char* kAutomatic = "auto";
/// Tolerance with this choice if none is given.
inline constexpr double kStandardTolerance = 1e-6;

struct IntegratorChoice {
  std::string integrator;
  std::string why;  ///< the reason, as text
};

/// Returns the choice. start: the state at time 0, with engaged joints.
IntegratorChoice choose_integrator(const Dynamics& dynamics, const ErrorScale& scale, const State& start);

}  // namespace pliant
