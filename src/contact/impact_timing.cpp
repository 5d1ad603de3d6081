#include <pliant/contact/impact_timing.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <pliant/math/index.h>

namespace pliant {

namespace {

/// An impact is located when the gap is this small, in sizes, or the time is known to this share of the step.
constexpr double kGap = 1e-13, kTime = 1e-15;
constexpr int kMaxTrials = 60;
/// Sides are apart if their gap is more than this, in sizes.
constexpr double kApart = 100 * kGap;
/// Sides that touch at the start, and are not apart after 2^-kMaxHalvings of the step, do not separate.
constexpr int kMaxHalvings = 20;
/// Accuracy of the time on the dense output, relative to the step.
constexpr double kOfPath = 1e-9;
/// Rates of gaps are differences over at least this share of the step; shorter ones are rounding.
constexpr double kForRate = 1e-6;
/// Most secant steps before the bracket takes over.
constexpr int kMaxSecants = 8;

/// Times that bracket an impact, with their gaps: positive at the lower one, not positive at the higher.
struct Bracket {
  double low, f_low, high, f_high;
  int side = 0;  ///< that the last trial was on

  /// Returns the zero of the secant, by the Illinois rule (Dowell and Jarratt 1971).
  double guess() const {
    const double tau = low + f_low * (high - low) / (f_low - f_high);
    return tau > low && tau < high ? tau : 0.5 * (low + high);
  }
  void narrow(double tau, double f) {
    const int now = f > 0 ? 1 : -1;
    if (now > 0) {
      low = tau;
      f_low = f;
      if (side == now) f_high *= 0.5;
    } else {
      high = tau;
      f_high = f;
      if (side == now) f_low *= 0.5;
    }
    side = now;
  }
};

/// Returns the time of the impact on the dense output, and the rate of the gap then. h: length of the step,
/// s.
template <class Gap>
std::pair<double, double> on_path(Bracket meets, double h, Gap&& gap) {
  double tau = meets.guess(), speed = (meets.f_high - meets.f_low) / (meets.high - meets.low);
  double f = gap(tau);
  for (int i = 0; i < kMaxTrials; ++i) {
    meets.narrow(tau, f);
    const double last = tau, f_last = f;
    tau = meets.guess();
    if (tau == last) break;
    f = gap(tau);
    if (std::abs(tau - last) > kForRate * h) speed = (f - f_last) / (tau - last);
    if (std::abs(tau - last) <= kOfPath * h) break;
  }
  return {tau, speed};
}

}  // namespace

// One function above 60 lines: its three searches share the bracket and the state that they move.
std::optional<double> locate_impact(StepContext& step, const ContactFinder& finder, Integrator& method,
                                    const FreeMotion& motion, const std::vector<Contact>& impacts) {
  const Dynamics& dynamics = step.dynamics;
  const State& before = motion.before;
  State& state = step.state;
  const double t = motion.begin, h = motion.h;
  double size = std::numeric_limits<double>::infinity(), largest = 0;
  for (const Contact& contact : impacts) {
    size = std::min(size, smaller_size(dynamics.model(), contact));
    for (const ContactSide* side : {&contact.a, &contact.b})
      if (side->part >= 0) largest = std::max(largest, dynamics.model().parts()[at(side->part)].part->size());
  }
  auto least_gap = [&](const State& of, double at_time) {
    double least = std::numeric_limits<double>::infinity();
    for (const Contact& contact : impacts)
      least = std::min(least, finder.least_gap(of, at_time, contact, 4 * largest));
    return least;
  };
  const StepPath path = method.path(dynamics, before, h, state, step.counters);
  double reached = h;  // time into the step of the state
  auto go_to = [&](double tau) {
    if (tau == reached) return;
    state = before;
    set_step(state, t, tau);
    StepContext part(dynamics, state, step.work, step.counters);
    method.step(part);
    reached = tau;
  };
  auto gap_at = [&](double tau) {
    go_to(tau);
    return least_gap(state, t + tau);
  };
  const double f_start = least_gap(before, t);
  Bracket meets{0, f_start, h, gap_at(h)};
  // Sides that separate from a touch are apart after some share of the step.
  if (!(f_start > kApart * size)) meets.f_low = 0;
  for (int i = 0; i < (f_start > 0 ? kMaxTrials : kMaxHalvings) && !(meets.f_low > 0); ++i) {
    const double tau = 0.5 * meets.high, f = gap_at(tau);
    if (f > 0) {
      meets.low = tau;
      meets.f_low = f;
    } else {
      meets.high = tau;
      meets.f_high = f;
    }
  }
  if (!(meets.f_low > 0)) {
    go_to(h);
    return std::nullopt;
  }
  // The dense output gives an approximate time and rate; steps then give the exact time.
  auto [tau, speed] = on_path(meets, h, [&, there = before](double into) mutable {
    path.at(into / h, there.q);
    return least_gap(there, t + into);
  });
  double last = 0, f_last = 0;
  for (int i = 0;
       i < kMaxTrials && meets.high - meets.low > kTime * h && !(std::abs(meets.f_high) <= kGap * size);
       ++i) {
    const double f = gap_at(tau);
    if (std::abs(f) <= kGap * size) return tau;
    if (i > 0) speed = (f - f_last) / (tau - last);
    meets.narrow(tau, f);
    last = tau;
    f_last = f;
    tau -= f / speed;
    if (i >= kMaxSecants || !(tau > meets.low && tau < meets.high)) tau = meets.guess();
  }
  go_to(meets.high);
  return meets.high;
}

void time_impacts(const ContactFinder& finder, const FreeMotion& motion, const State& state,
                  std::vector<Contact>& contacts) {
  for (Contact& contact : contacts) {
    if (contact.since > 0) continue;
    const double u = finder.velocity(state, contact).dot(contact.normal);
    contact.since = u < 0 && contact.gap < 0 ? std::min(motion.h, contact.gap / u) : motion.held();
    const double u_start = finder.velocity(motion.before, contact).dot(contact.normal);
    if (!(u < 0 && contact.gap < 0 && u_start < -motion.slow)) continue;
    // The force that pushes the sides together has acted since then too.
    const double gained = (u - u_start) / motion.h * contact.since, approach = gained - u;
    if (contact.restitution * approach > motion.slow)
      contact.rebound = std::max(0.0, contact.restitution * approach + gained);
  }
}

}  // namespace pliant
