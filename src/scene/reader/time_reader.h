// Functions of time in a scene, tried out over the whole run: those that are not finite are refused at their
// place.
#pragma once

#include <optional>

#include <pliant/math/time_function.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// What a use of a function of time asks of it.
enum class Needs { value, value_and_rate };

class TimeReader {
 public:
  /// end: of the run, s.
  TimeReader(double end, SceneFaults& faults) : end_(end), faults_(faults) {}

  /// Of the run, s.
  double end() const { return end_; }
  /// The function of a sound value; none, with a fault, when it is not finite at one of many times from 0 to
  /// the end.
  std::optional<TimeFunction> function(const JsonValue& value, Needs needs) const;
  /// The three functions under a key, with faults for each; none when one is not good.
  std::optional<TimeVector> vector(const Reader& r, const char* key, Needs needs) const;

 private:
  bool finite(const JsonValue& at, const TimeFunction& f, Needs needs) const;

  double end_;
  SceneFaults& faults_;
};

}  // namespace pliant
