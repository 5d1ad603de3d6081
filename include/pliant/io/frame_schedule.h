// The steps of a run, the states that it records, and the times of its frames. A frame is the picture or the
// mesh file of one moment; frame k is at time k / rate. A frame at the end of a step shows the state there.
// For a frame within a step, the states at the start and at the end of the step are recorded, so that the
// frame is interpolated within a single step. The first and the last state are always recorded. With variable
// steps, a state is recorded if a frame is within the step before it or may be within the step after it.
#pragma once

#include <cstdint>

namespace pliant {

class FrameSchedule {
 public:
  /// Makes the schedule of a run from time 0 to `end` (s, >= 0) in steps of about `step` (s, > 0), with
  /// `rate` (> 0) frames per second. If end is not a multiple of step (to a relative 1e-9), the step is
  /// reduced to end / ceil(end / step). Throws std::invalid_argument if a number is out of range, or if the
  /// run would have more than 1e12 steps or frames.
  FrameSchedule(double end, double step, double rate);
  /// Returns the schedule of a resumed run, whose step must not change. The run ends with the first step that
  /// ends at or after `end`.
  static FrameSchedule with_exact_step(double end, double step, double rate);
  /// Returns the schedule of a run with variable steps (error control).
  static FrameSchedule with_free_steps(double end, double rate);

  double step() const { return step_; }          ///< fixed step in use, s; 0 for variable steps
  std::int64_t steps() const { return steps_; }  ///< steps of the whole run; 0 for variable steps
  double rate() const { return rate_; }
  double end() const { return end_; }
  /// Returns whether the state after this number of fixed steps is recorded.
  bool records(std::int64_t step) const;
  /// For variable steps: returns whether the state at `time` is recorded. before: time of the previous state;
  /// next: largest length of the next step, all in s.
  bool records(double before, double time, double next) const;
  /// Returns the number of frames from time 0 to a time (s), both included, or without argument to the end of
  /// the run.
  std::int64_t frames(double until) const;
  std::int64_t frames() const { return frames(end()); }
  double frame_time(std::int64_t k) const { return static_cast<double>(k) / rate_; }

 private:
  FrameSchedule() = default;

  double step_ = 0, rate_ = 0, end_ = 0;
  std::int64_t steps_ = 0;
};

}  // namespace pliant
