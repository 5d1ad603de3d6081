// The times at which impacts happen within a motion. locate_impact() finds the first zero of the smallest
// gap: a bracket, regula falsi on the dense output of the method (Illinois variant, Dowell and Jarratt 1971),
// then secants with steps of the method. The paper has no such search.
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

/// Returns the time into the motion at which the first of the impacts happens, s, and sets the state to that
/// time. Returns none if their sides were not apart before.
std::optional<double> locate_impact(StepContext& step, const ContactFinder& finder, Integrator& method,
                                    const FreeMotion& motion, const std::vector<Contact>& impacts);

/// Sets the `since` of contacts at the end of a motion: the time since their sides met, s, at their present
/// normal velocity. Sets their `rebound` too. Does not change resting contacts, which have a `since`.
void time_impacts(const ContactFinder& finder, const FreeMotion& motion, const State& state,
                  std::vector<Contact>& contacts);

}  // namespace pliant
