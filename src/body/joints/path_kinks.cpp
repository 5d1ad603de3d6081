// The times at which the prescribed position of an end of a joint, or the rate of this position, jumps.
#include <algorithm>
#include <limits>

#include <pliant/body/model.h>

namespace pliant {

namespace {
/// A joint switches on at the time `on`. A kink before `on` counts as a kink at `on` if it is earlier by less
/// than kUlps times the machine epsilon times |on|.
constexpr double kUlps = 8;
}  // namespace

Kink Model::next_kink(double after, double until) const {
  Kink next;
  for (const int j : driven_joints_)
    next = next.or_sooner(next_kink(joints_[static_cast<std::size_t>(j)], after, until));
  return next;
}

Kink Model::next_kink(const JointModel& joint, double after, double until) const {
  const double on = joint.joint->on();
  after = std::max(after, on - kUlps * std::numeric_limits<double>::epsilon() * std::abs(on));
  until = std::min(until, joint.joint->off());
  Kink next;
  const Part* last = nullptr;
  for (const Point& point : joint.joint->points()) {
    if (point.part != nullptr && point.part == last) continue;
    last = point.part;
    next = next.or_sooner(first_kink(point, after, until));
  }
  return next;
}

}  // namespace pliant
