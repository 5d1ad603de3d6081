// Reading functions of time. Each function is evaluated at 257 times of the run. Values that are not finite
// are reported.
#pragma once

#include <optional>

#include <pliant/math/time_function.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// The quantities of a function of time that must be finite.
enum class Needs { value, value_and_rate };

class TimeReader {
 public:
  /// end: end of the run, s.
  TimeReader(double end, SceneFaults& faults) : end_(end), faults_(faults) {}

  /// Number of equal intervals of the run at whose ends functions are evaluated.
  static constexpr int kIntervals = 256;

  /// End of the run, s.
  double end() const { return end_; }
  /// Returns the function that a validated value describes. Reports a fault and returns std::nullopt if
  /// the function is not finite at one of 257 times from 0 to the end.
  std::optional<TimeFunction> function(const JsonValue& value, Needs needs) const;
  /// Returns the three functions under a key, or std::nullopt if the key is absent or a function is
  /// faulty. Each fault is reported.
  std::optional<TimeVector> vector(const Reader& r, const char* key, Needs needs) const;

 private:
  bool finite(const JsonValue& at, const TimeFunction& f, Needs needs) const;

  double end_;
  SceneFaults& faults_;
};

}  // namespace pliant
