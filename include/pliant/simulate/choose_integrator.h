// The choice of the method of integration for a model and a tolerance. If nothing is elastic or damped, the
// choice is an explicit method of high order. Otherwise each candidate takes some steps from the start, and
// the choice is the candidate with the most simulated time per cost. The cost is a number of evaluations of
// the accelerations; no time is measured.
#pragma once

#include <functional>
#include <stdexcept>
#include <string>

#include <pliant/method/integrator.h>

namespace pliant {

/// The name that requests this choice; use it in place of the name of a method.
inline constexpr const char* kAutomatic = "auto";
/// The tolerance that is used with kAutomatic if no tolerance is given.
inline constexpr double kStandardTolerance = 1e-6;

/// Returns whether the model has drives, springs that act at time t (s), or a moving part with elasticity,
/// damping or drag.
bool has_stiffness(const Model& model, double t);

struct IntegratorChoice {
  std::string integrator;
  std::string why;  ///< the reason, as text
};

/// The choice ended because the caller's function `stop` returned true.
class ChoiceStopped : public std::runtime_error {
 public:
  ChoiceStopped() : std::runtime_error("the choice of the integrator was stopped") {}
};

/// Returns a low estimate of the time of one evaluation of a part on one core, microseconds. Its constants
/// were once measured and are fixed in the code, so that the result is the same on every machine.
double evaluation_cost(const Part& part);

/// Returns the choice. If all candidates fail, the choice is the first candidate, dop853. Among equally fast
/// candidates, the choice is the first. start: the state at time 0, with engaged joints. stop: called before
/// every step of a trial; may be empty. Throws ChoiceStopped if stop() returns true. The number of
/// evaluations of each trial is limited, so that the trial of a large model takes some seconds.
IntegratorChoice choose_integrator(const Dynamics& dynamics, const ErrorScale& scale, const State& start,
                                   const std::function<bool()>& stop);

}  // namespace pliant
