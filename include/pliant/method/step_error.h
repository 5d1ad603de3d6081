// The estimated error of one step.
#pragma once

namespace pliant {

/// The error of a step and the order of its estimate.
struct StepError {
  double error;   ///< in tolerances; not finite if the step failed
  int order;      ///< p if the estimate is O(h^(p + 1))
  double length;  ///< length of the step, s; an impact may have ended the step early
};

}  // namespace pliant
