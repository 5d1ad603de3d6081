#include <pliant/integrate/impact_timing.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/math/index.h>

namespace pliant {

namespace {

/// An impact is told in time when the gap is this small, in sizes, or the time known to this part of the
/// step.
constexpr double kGap = 1e-13, kTime = 1e-15;
constexpr int kMostTrials = 60;
/// Sides that touch at the start and are not apart after one in two to this power of the step meet all along.
constexpr int kMostHalvings = 20;

}  // namespace

std::optional<double> locate_impact(const Dynamics& dynamics, const ContactFinder& finder, Integrator& method,
                                    const State& before, double t, double h,
                                    const std::vector<Contact>& impacts, State& state,
                                    Workspace<double>& work, StepCounters& counters) {
  double size = std::numeric_limits<double>::infinity(), largest = 0;
  for (const Contact& contact : impacts) {
    size = std::min(size, dynamics.model().parts()[at(contact.a.part)].part->size());
    largest = std::max(largest, dynamics.model().parts()[at(contact.a.part)].part->size());
  }
  double reached = h;  // how far into the step the state is
  auto go_to = [&](double tau) {
    if (tau == reached) return;
    state = before;
    set_step(state, t, tau);
    method.step(dynamics, state, work, counters);
    reached = tau;
  };
  auto gap_at = [&](double tau) {
    go_to(tau);
    double least = std::numeric_limits<double>::infinity();
    for (const Contact& contact : impacts)
      least = std::min(least, finder.least_gap(state, t + tau, contact, 4 * largest));
    return least;
  };
  const bool apart = std::all_of(impacts.begin(), impacts.end(), [&](const Contact& contact) {
    return finder.least_gap(before, t, contact, 4 * largest) > 0;
  });
  double high = h, f_high = gap_at(h), low = h, f_low = f_high;
  // They were apart after some part of the step.
  for (int i = 0; i < (apart ? kMostTrials : kMostHalvings) && !(f_low > 0); ++i) {
    low *= 0.5;
    f_low = gap_at(low);
    if (!(f_low > 0)) {
      high = low;
      f_high = f_low;
    }
  }
  if (!(f_low > 0)) {
    go_to(h);
    return std::nullopt;
  }
  int side = 0;
  double tau = high;
  for (int i = 0; i < kMostTrials && high - low > kTime * h && !(std::abs(f_high) <= kGap * size); ++i) {
    tau = low + f_low * (high - low) / (f_low - f_high);
    if (!(tau > low && tau < high)) tau = 0.5 * (low + high);
    const double f = gap_at(tau);
    if (f > 0) {
      low = tau;
      f_low = f;
      if (side > 0) f_high *= 0.5;
      side = 1;
    } else {
      high = tau;
      f_high = f;
      if (side < 0) f_low *= 0.5;
      side = -1;
    }
  }
  go_to(high);
  return high;
}

void time_impacts(const ContactFinder& finder, const FreeMotion& motion, const State& state,
                  std::vector<Contact>& contacts) {
  for (Contact& contact : contacts) {
    if (contact.since > 0) continue;
    const double u = finder.velocity(state, contact).dot(contact.normal);
    contact.since = u < 0 && contact.gap < 0 ? std::min(motion.h, contact.gap / u) : motion.held();
    const double u_start = finder.velocity(motion.before, contact).dot(contact.normal);
    if (!(u < 0 && contact.gap < 0 && u_start < -motion.slow)) continue;
    // What pushes the sides together has done so since then too.
    const double gained = (u - u_start) / motion.h * contact.since, approach = gained - u;
    if (contact.restitution * approach > motion.slow)
      contact.rebound = std::max(0.0, contact.restitution * approach + gained);
  }
}

}  // namespace pliant
