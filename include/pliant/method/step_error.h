// The estimated error of one step.
#pragma once

namespace pliant {

/// The error of a step in tolerances (not finite if the step failed), and the order of the estimate.
struct StepError {
  double error;
  int order;
  double length;  ///< length of the step, s; it may have ended early, at an impact
};

}  // namespace pliant
