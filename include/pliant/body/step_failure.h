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

/// A step needs more memory than there is.
class OutOfMemory : public std::bad_alloc {
 public:
  explicit OutOfMemory(std::string what) : what_(std::move(what)) {}
  const char* what() const noexcept override { return what_.c_str(); }

 private:
  std::string what_;
};

}  // namespace pliant
