// Which steps a run takes, which of them it records, and at which times pictures are taken. Frame k is at k /
// rate. A frame that falls on a step is that step's state; of one between two steps both are recorded, so
// that the picture comes from Hermite interpolation over a single step. The first and the last state are
// always recorded. Where steps find their own length, those are recorded that end at a frame or after it, and
// those that the next may lead beyond one.
#pragma once

#include <cstdint>

namespace pliant {

class FrameSchedule {
 public:
  /// A run from 0 to `end` (s, >= 0) in steps of about `step` (s, > 0), with `rate` (> 0) frames per second.
  /// Where end is no multiple of step (to 1e-9) the step is made smaller, to end / ceil(end / step). Throws
  /// std::invalid_argument when a number is out of range or more than 1e12 steps would be needed.
  FrameSchedule(double end, double step, double rate);
  /// The same with a step that must not change (a run goes on): the end is the first step at or after `end`.
  static FrameSchedule with_exact_step(double end, double step, double rate);
  /// The same of steps that find their own length.
  static FrameSchedule with_free_steps(double end, double rate);

  double step() const { return step_; }          ///< s, as it is taken; 0 of free steps
  std::int64_t steps() const { return steps_; }  ///< of the whole run; 0 of free steps
  double rate() const { return rate_; }
  double end() const { return end_; }
  bool records(std::int64_t step) const;
  /// Of free steps: whether a state at a time is recorded, the last one before it being at another, and the
  /// next step being so long at most (s).
  bool records(double before, double time, double next) const;
  /// Frames up to a time of the run (or to its end): 0 <= k < frames().
  std::int64_t frames(double until) const;
  std::int64_t frames() const { return frames(end()); }
  double frame_time(std::int64_t k) const { return static_cast<double>(k) / rate_; }

 private:
  FrameSchedule() = default;

  double step_ = 0, rate_ = 0, end_ = 0;
  std::int64_t steps_ = 0;
};

}  // namespace pliant
