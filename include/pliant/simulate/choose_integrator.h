// The choice of the method of integration for a model and a tolerance. If nothing is elastic or damped, the
// choice is an explicit method of high order. Otherwise each candidate takes some steps from the start, and
// the choice is the candidate with the most simulated time per cost. The cost is a number of evaluations of
// the accelerations; no time is measured.
#pragma once

#include <string>

#include <pliant/method/integrator.h>

namespace pliant {

/// The name that requests this choice; use it in place of the name of a method.
inline constexpr const char* kAutomatic = "auto";
/// The tolerance that is used with kAutomatic if none is given.
inline constexpr double kStandardTolerance = 1e-6;

struct IntegratorChoice {
  std::string integrator;
  std::string why;  ///< the reason, as text
};

/// Returns the choice. If all candidates fail, it is the first candidate, dop853; between equal candidates it
/// is the first one. start: the state at time 0, with engaged joints.
IntegratorChoice choose_integrator(const Dynamics& dynamics, const ErrorScale& scale, const State& start);

}  // namespace pliant
