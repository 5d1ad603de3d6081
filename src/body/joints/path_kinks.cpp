// Kinks of a model: the times at which the prescribed position of an end of a joint or spring, or the rate of
// this position, jumps; the times at which springs are switched on or off; and the multiples of
// 1 / MultiBody::stop_rate.
#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/body/model.h>

namespace pliant {

namespace {
/// A joint acts from the time `on`. Its kinks include a kink that is earlier than `on` by a rounding error:
/// by less than kUlps times the machine epsilon times |on|.
constexpr double kUlps = 8;

/// Returns the first multiple of 1 / rate later than `after` and no later than `until`, s.
Kink next_multiple(double rate, double after, double until) {
  constexpr double kMaxMultiple = 1e15;  // smaller integers k, and k + 1, are exact
  double k = std::floor(after * rate);
  if (!(k < kMaxMultiple)) return {};
  while (k / rate <= after) ++k;
  return k / rate <= until ? Kink{k / rate, false} : Kink();
}

bool is_driven(const Point& end) {
  return end.part == nullptr ? !end.world.is_constant() : end.part->motion() != nullptr;
}
bool may_have_kinks(const Spring& spring) {
  return is_driven(spring.a) || is_driven(spring.b) || spring.on > 0 || std::isfinite(spring.off);
}
}  // namespace

bool Model::may_have_kinks() const {
  return !driven_joints_.empty() || body_->stop_rate > 0 ||
         std::any_of(springs_.begin(), springs_.end(),
                     [](const SpringModel& spring) { return pliant::may_have_kinks(*spring.spring); });
}

Kink Model::next_kink(double after, double until) const {
  Kink next;
  for (const int j : driven_joints_)
    next = next.or_sooner(next_kink(joints_[static_cast<std::size_t>(j)], after, until));
  for (const SpringModel& spring : springs_)
    if (pliant::may_have_kinks(*spring.spring)) next = next.or_sooner(next_kink(spring, after, until));
  if (body_->stop_rate > 0) next = next.or_sooner(next_multiple(body_->stop_rate, after, until));
  return next;
}

Kink Model::next_kink(const SpringModel& spring, double after, double until) const {
  const Spring& s = *spring.spring;
  Kink next;
  for (const double time : {s.on, s.off})
    if (time > 0 && after < time && time <= until) next = next.or_sooner({time, false});
  const double from = std::max(after, s.on), to = std::min(until, s.off);
  if (!(from < to)) return next;
  return next.or_sooner(first_kink(s.a, from, to)).or_sooner(first_kink(s.b, from, to));
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
