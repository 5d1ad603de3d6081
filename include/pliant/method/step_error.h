// The estimated error of one step.
#pragma once

namespace pliant {

/// How wrong a step is, in tolerances, not a finite number where it failed, and the order of that estimate.
struct StepError {
  double error;
  int order;
  double length;  ///< of the step as it was taken, s: it may have ended where bodies met
};

}  // namespace pliant
