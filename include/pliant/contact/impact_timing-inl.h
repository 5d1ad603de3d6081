// Function bodies of impact_timing.h. locate_impact(), near the end, finds the time of the first impact
// within a motion: bracket_impact() brackets it, locate_on_path() finds it on the dense output of the method,
// and refine_impact() finds the exact time with steps of the method.
#pragma once

#include <pliant/contact/impact_timing.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace impact_timing {

/// refine_impact() ends if the gap or overlap is at most kGapTolerance sizes of the smallest part, or if the
/// time is known to kTimeTolerance of the motion.
inline constexpr double kGapTolerance = 1e-13, kTimeTolerance = 1e-15;
/// Largest number of trial times of each search.
inline constexpr int kMaxTrials = 60;
/// The sides of an impact are apart at the start of the motion if their gap is larger than this, in sizes of
/// the smallest part.
inline constexpr double kClearGap = 100 * kGapTolerance;
/// Sides whose gap is not positive at the start are assumed to touch all the time in two cases: the dense
/// output shows no gap at the times h 2^-k for k from 1 to kMaxHalvings, or steps of the method find no gap
/// either. h: length of the motion.
inline constexpr int kMaxHalvings = 20;
/// Accuracy of the time on the dense output, as a share of the motion.
inline constexpr double kPathTolerance = 1e-9;
/// The rate of a gap is computed from times that differ by more than this, as a share of the motion. For
/// closer times the difference of the gaps is mostly rounding error.
inline constexpr double kMinRateInterval = 1e-6;
/// After this number of secant steps the search halves the bracket.
inline constexpr int kMaxSecants = 8;

/// An interval of times, s, that contains the impact, with the gaps at its ends, m: positive at the lower
/// end, zero or negative at the upper end.
struct Bracket {
  double low, f_low, high, f_high;
  int last_end = 0;  ///< end that the last trial replaced: 1 lower, -1 upper

  /// Returns the time of zero gap by regula falsi. The Illinois variant (Dowell and Jarratt 1971) halves the
  /// value of an end that is retained twice.
  double guess() const {
    const double tau = low + f_low * (high - low) / (f_low - f_high);
    return tau > low && tau < high ? tau : 0.5 * (low + high);
  }
  void narrow(double tau, double f) {
    const int end = f > 0 ? 1 : -1;
    if (end > 0) {
      low = tau;
      f_low = f;
      if (last_end == end) f_high *= 0.5;
    } else {
      high = tau;
      f_high = f;
      if (last_end == end) f_low *= 0.5;
    }
    last_end = end;
  }
};

/// A time of impact, s, and the rate of the gap there, m/s; negative: the sides approach.
struct TimeAndRate {
  double tau, rate;
};

/// Returns the time of impact on the dense output and the rate of the gap there. h: length of the motion, s.
/// gap: function that returns the gap (m) at a time into the motion (s).
template <class Gap>
TimeAndRate locate_on_path(Bracket bracket, double h, Gap&& gap) {
  double tau = bracket.guess(), rate = (bracket.f_high - bracket.f_low) / (bracket.high - bracket.low);
  double f = gap(tau);
  for (int i = 0; i < kMaxTrials; ++i) {
    bracket.narrow(tau, f);
    const double last = tau, f_last = f;
    tau = bracket.guess();
    if (tau == last) break;
    f = gap(tau);
    if (std::abs(tau - last) > kMinRateInterval * h) rate = (f - f_last) / (tau - last);
    if (std::abs(tau - last) <= kPathTolerance * h) break;
  }
  return {tau, rate};
}

/// The smallest gap of some impacts, at states within a motion.
class ImpactGap {
 public:
  ImpactGap(StepContext& step, const ContactFinder& finder, Integrator& method, const FreeMotion& motion,
            const std::vector<Contact>& impacts)
      : step_(step),
        finder_(finder),
        method_(method),
        motion_(motion),
        impacts_(impacts),
        reached_(motion.h) {
    const Model& model = step.model();
    for (const Contact& contact : impacts) {
      size_ = std::min(size_, smaller_size(model, contact));
      for (const ContactSide* side : {&contact.a, &contact.b})
        if (side->part >= 0) largest_ = std::max(largest_, model.parts()[at(side->part)].size);
    }
  }

  /// Returns the size of the smallest part at the impacts, m.
  double size() const { return size_; }
  /// Returns the smallest gap at a state and a time, m.
  double at_state(const State& state, double t) const {
    double smallest = std::numeric_limits<double>::infinity();
    for (const Contact& contact : impacts_)
      smallest = std::min(smallest, finder_.min_gap(state, t, contact, 4 * largest_));
    return smallest;
  }
  /// Moves the state of the step to a time tau into the motion, s, by a step of the method.
  void move_to(double tau) {
    if (tau == reached_) return;
    step_.state = motion_.before;
    set_step(step_.state, motion_.begin, tau);
    StepContext part(step_.dynamics, step_.state, step_.work, step_.counters);
    method_.step(part);
    reached_ = tau;
  }
  /// Moves the state of the step to a time tau into the motion, s, and returns the smallest gap there, m.
  double at_time(double tau) {
    move_to(tau);
    return at_state(step_.state, motion_.begin + tau);
  }

 private:
  StepContext& step_;
  const ContactFinder& finder_;
  Integrator& method_;
  const FreeMotion& motion_;
  const std::vector<Contact>& impacts_;
  double reached_;  // time of the state into the motion, s
  double size_ = std::numeric_limits<double>::infinity(), largest_ = 0;
};

/// Returns whether sides that touch at the start of a motion separate on the dense output: their gap exceeds
/// clear_gap (m) at one of the times h 2^-k for k from 1 to `halvings`.
template <class Gap>
bool separates_on_path(Gap&& gap_on_path, double h, int halvings, double clear_gap) {
  for (int k = 1; k <= halvings; ++k)
    if (gap_on_path(std::ldexp(h, -k)) > clear_gap) return true;
  return false;
}

/// Returns a bracket of the first impact. Its lower gap f_low is not positive if the sides touch all the
/// time. gap_on_path: function that returns the gap (m) on the dense output at a time into the motion (s).
template <class Gap>
Bracket bracket_impact(ImpactGap& gap, Gap&& gap_on_path, double gap_at_start, double h) {
  Bracket bracket{0, gap_at_start, h, gap.at_time(h)};
  if (gap_at_start > kClearGap * gap.size()) return bracket;
  // Sides that touch at the start may separate and meet again. Halvings of the interval find a time at which
  // they are apart: first on the dense output, which needs no evaluations, then by steps of the method.
  bracket.f_low = 0;
  const int halvings = gap_at_start > 0 ? kMaxTrials : kMaxHalvings;
  if (!separates_on_path(gap_on_path, h, halvings, kClearGap * gap.size())) return bracket;
  for (int k = 1; k <= halvings && !(bracket.f_low > 0); ++k) {
    const double tau = 0.5 * bracket.high, f = gap.at_time(tau);
    if (f > 0) {
      bracket.low = tau;
      bracket.f_low = f;
    } else {
      bracket.high = tau;
      bracket.f_high = f;
    }
  }
  return bracket;
}

/// Returns the exact time of impact by the secant method with steps of the method of integration, within a
/// bracket; the state is at this time afterwards. approximate: the time and rate on the dense output. If the
/// sides overlap deeply enough at the end of the bracket, the result is the time of a small overlap, not of a
/// zero gap. Otherwise a point that only grazes the other side could end the search, although another point
/// meets that side a little later and faster.
inline double refine_impact(ImpactGap& gap, Bracket bracket, double h, TimeAndRate approximate) {
  const double exact = kGapTolerance * gap.size(), overlap = bracket.f_high < -exact ? 0.5 * exact : 0,
               accuracy = overlap > 0 ? 0.5 * overlap : exact;
  bracket.f_low += overlap;
  bracket.f_high += overlap;
  auto [tau, rate] = approximate;
  double last = 0, f_last = 0;
  for (int i = 0; i < kMaxTrials && bracket.high - bracket.low > kTimeTolerance * h &&
                  !(std::abs(bracket.f_high) <= accuracy);
       ++i) {
    const double f = gap.at_time(tau) + overlap;
    if (std::abs(f) <= accuracy) return tau;
    if (i > 0) rate = (f - f_last) / (tau - last);
    bracket.narrow(tau, f);
    last = tau;
    f_last = f;
    tau -= f / rate;
    if (i >= kMaxSecants)
      tau = 0.5 * (bracket.low + bracket.high);
    else if (!(tau > bracket.low && tau < bracket.high))
      tau = bracket.guess();
  }
  gap.move_to(bracket.high);
  return bracket.high;
}

}  // namespace impact_timing

PLIANT_INLINE std::optional<double> locate_impact(StepContext& step, const ContactFinder& finder,
                                                  Integrator& method, const FreeMotion& motion,
                                                  const std::vector<Contact>& impacts) {
  const State& before = motion.before;
  const double t = motion.begin, h = motion.h;
  const StepPath path = method.path(step.dynamics, before, h, step.state, step.counters);
  impact_timing::ImpactGap gap(step, finder, method, motion, impacts);
  auto gap_on_path = [&, there = before](double tau) mutable {
    path.at(tau / h, there.q);
    return gap.at_state(there, t + tau);
  };
  const impact_timing::Bracket bracket =
      impact_timing::bracket_impact(gap, gap_on_path, gap.at_state(before, t), h);
  if (!(bracket.f_low > 0)) {
    gap.move_to(h);
    return std::nullopt;
  }
  const auto approximate = impact_timing::locate_on_path(bracket, h, gap_on_path);
  return impact_timing::refine_impact(gap, bracket, h, approximate);
}

PLIANT_INLINE double gained_velocity(const ContactFinder& finder, const FreeMotion& motion,
                                     const State& state, const Contact& contact) {
  const double u = finder.velocity(state, contact).dot(contact.normal),
               u_start = finder.velocity(motion.before, contact).dot(contact.normal);
  return (u - u_start) / motion.h * std::min(motion.h, contact.gap / u);
}

PLIANT_INLINE void time_impacts(const ContactFinder& finder, const FreeMotion& motion, const State& state,
                                std::vector<Contact>& contacts) {
  for (Contact& contact : contacts) {
    if (contact.since > 0) continue;
    const double u = finder.velocity(state, contact).dot(contact.normal);
    contact.since = u < 0 && contact.gap < 0 ? std::min(motion.h, contact.gap / u) : motion.force_time();
    const double u_start = finder.velocity(motion.before, contact).dot(contact.normal);
    if (!(u < 0 && contact.gap < 0 && u_start < -motion.min_impact_speed)) continue;
    // The acceleration that pushes the sides together has acted since the impact too.
    const double gained = gained_velocity(finder, motion, state, contact), approach = gained - u;
    if (contact.restitution * approach > motion.min_impact_speed)
      contact.rebound = std::max(0.0, contact.restitution * approach + gained);
  }
}

}  // namespace pliant
