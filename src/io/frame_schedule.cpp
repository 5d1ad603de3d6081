#include <pliant/io/frame_schedule.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include <pliant/io/format/number_text.h>

namespace pliant {
namespace {

constexpr double kMaxSteps = 1e12;
/// Largest distance of a frame from the end of a step, relative to the step, at which the frame shows the
/// state at the end of the step.
constexpr double kOnStep = 1e-6;

void require(bool good, const char* name, double value, const char* expected) {
  if (!good)
    throw std::invalid_argument(std::string(name) + " " + number_text(value) + " must be " + expected);
}

// Returns end / step: the nearest integer if they differ by rounding errors only, or else rounded up. Throws
// std::invalid_argument if an argument is out of range, or if there are more than 1e12 steps or frames.
double steps_between(double end, double step, double rate) {
  require(std::isfinite(end) && end >= 0, "the end time", end, "a number of seconds >= 0");
  require(std::isfinite(step) && step > 0, "the step", step, "a number of seconds > 0");
  require(std::isfinite(rate) && rate > 0, "the frame rate", rate, "a number per second > 0");
  const double exact = end / step, near = std::round(exact);
  const double steps = std::abs(exact - near) <= 1e-9 * std::max(1.0, exact) ? near : std::ceil(exact);
  if (!(steps <= kMaxSteps))
    throw std::invalid_argument("a run to " + number_text(end) + " s in steps of " + number_text(step) +
                                " s needs " + number_text(steps) + " steps; the limit is 1e12");
  if (!(end * rate <= kMaxSteps))
    throw std::invalid_argument("a run to " + number_text(end) + " s has " + number_text(end * rate) +
                                " frames; the limit is 1e12");
  return steps;
}

}  // namespace

FrameSchedule::FrameSchedule(double end, double step, double rate) : step_(step), rate_(rate) {
  const double steps = steps_between(end, step, rate);
  steps_ = static_cast<std::int64_t>(steps);
  if (steps > 0 && std::abs(steps * step - end) > 1e-9 * end) step_ = end / steps;
  end_ = steps * step_;
}

FrameSchedule FrameSchedule::with_free_steps(double end, double rate) {
  FrameSchedule schedule(end, std::max(end, 1.0), rate);
  schedule.step_ = 0;
  schedule.steps_ = 0;
  schedule.end_ = end;
  return schedule;
}

FrameSchedule FrameSchedule::with_exact_step(double end, double step, double rate) {
  FrameSchedule schedule;
  schedule.step_ = step;
  schedule.rate_ = rate;
  schedule.steps_ = static_cast<std::int64_t>(steps_between(end, step, rate));
  schedule.end_ = static_cast<double>(schedule.steps_) * step;
  return schedule;
}

bool FrameSchedule::records(std::int64_t step) const {
  if (step == 0 || step == steps_) return true;
  if (step < 0 || step > steps_) return false;
  const double per_step = rate_ * step_, at = static_cast<double>(step);
  const auto near = static_cast<std::int64_t>(std::floor(at * per_step));
  const std::int64_t count = frames();
  for (std::int64_t k = std::max<std::int64_t>(0, near - 1); k <= near + 2 && k < count; ++k) {
    const double place = static_cast<double>(k) / per_step, on = std::round(place);
    if (std::abs(place - on) <= kOnStep ? on == at : std::abs(place - at) < 1) return true;
  }
  return false;
}

bool FrameSchedule::records(double before, double time, double next) const {
  const double reach = time + 1.02 * next;  // the last step before the end may be slightly longer
  return time == 0 || reach >= end_ || frames(reach) != frames(before);
}

std::int64_t FrameSchedule::frames(double until) const {
  return static_cast<std::int64_t>(std::floor(until * rate_ + kOnStep * rate_ * step_ + 1e-9)) + 1;
}

}  // namespace pliant
