// The longest step of a simulation with a tolerance, while bodies rest on each other and the error of contact
// is not controlled.
#pragma once

#include <algorithm>

#include <pliant/body/contact_settings.h>

namespace pliant {

/// Returns the length of this longest step, s: settings.longest_step for tolerances up to 5e-4. For larger
/// tolerances it grows in proportion to the tolerance, up to ten times settings.longest_step, because the
/// error of contact is of first order.
inline double longest_contact_step(const ContactSettings& settings, double tolerance) {
  constexpr double reference = 5e-4, max_factor = 10;
  return settings.longest_step * std::clamp(tolerance / reference, 1.0, max_factor);
}

}  // namespace pliant
