// Why a step could not be done. The simulation still holds the last good state.
#pragma once

#include <stdexcept>
#include <string>

namespace pliant {

class StepFailure : public std::runtime_error {
 public:
  StepFailure(const std::string& what, double at) : std::runtime_error(what), time(at) {}
  double time;  ///< of the last good state, s
};

/// A step gave a number that is not finite.
class NumericalFailure : public StepFailure {
  using StepFailure::StepFailure;
};

/// Joints contradict each other; the message names them and the gap.
class UnsatisfiableModel : public StepFailure {
  using StepFailure::StepFailure;
};

}  // namespace pliant
