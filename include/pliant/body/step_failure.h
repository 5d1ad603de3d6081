// The exceptions of a step that fails. The simulation keeps its last good state.
#pragma once

#include <new>
#include <stdexcept>
#include <string>
#include <utility>

namespace pliant {

class StepFailure : public std::runtime_error {
 public:
  StepFailure(const std::string& what, double at) : std::runtime_error(what), time(at) {}
  double time;  ///< time of the failure, s: start or end of the step, or a time within the step
};

/// A step gave a number that is not finite, or a numerical method failed, for instance because the step is
/// too long.
class NumericalFailure : public StepFailure {
  using StepFailure::StepFailure;
};

/// Joints contradict each other, cannot be closed by the assembly before time 0, or have a prescribed path
/// that jumps. The message names the joints.
class UnsatisfiableModel : public StepFailure {
  using StepFailure::StepFailure;
};

/// A step needs more memory than is available.
class OutOfMemory : public std::bad_alloc {
 public:
  explicit OutOfMemory(std::string what) : what_(std::move(what)) {}
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

}  // namespace pliant
