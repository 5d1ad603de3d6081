// The times at which impacts happen within a motion. locate_impact() finds the first zero of the smallest
// gap: a bracket, regula falsi on the dense output of the method (Illinois variant, Dowell and Jarratt 1971),
// then the secant method on steps of the method of integration. The paper has no such search.
#pragma once

#include <optional>
#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/contact/free_motion.h>
#include <pliant/method/integrator.h>

namespace pliant {

/// Sets the start t (s) and the length h (s) of the next step of a method.
inline void set_step(State& state, double t, double h) {
  state.start = t;
  state.step = 0;
  state.h = h;
}

/// Returns the time from the start of the motion to the first of the impacts, s, and sets step.state to that
/// time. Returns std::nullopt if the sides of the impacts touch during the whole motion; step.state is then
/// at the end of the motion.
std::optional<double> locate_impact(StepContext& step, const ContactFinder& finder, Integrator& method,
                                    const FreeMotion& motion, const std::vector<Contact>& impacts);

/// Returns the normal velocity that the accelerations during the motion have given the sides of a contact
/// since they met, m/s; negative: they push the sides together. state: at the end of the motion, at which the
/// sides overlap and approach.
double gained_velocity(const ContactFinder& finder, const FreeMotion& motion, const State& state,
                       const Contact& contact);

/// Sets Contact::since (s) of contacts at the end of a motion. This is the time since their sides met,
/// computed as gap / present normal velocity, and at most the length of the motion. If the sides do not
/// overlap or do not approach, the time is force_time() of the motion. Sets Contact::rebound if three
/// conditions hold. The sides overlap and approach at the end of the motion. They approached faster than
/// motion.min_impact_speed at its start. The restitution times their approach speed at the impact exceeds
/// min_impact_speed. Contacts whose `since` is positive, the resting contacts, do not change.
void time_impacts(const ContactFinder& finder, const FreeMotion& motion, const State& state,
                  std::vector<Contact>& contacts);

}  // namespace pliant
