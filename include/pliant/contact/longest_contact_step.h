// The longest step to a tolerance while bodies rest on each other and the error of contact is not controlled.
#pragma once

#include <algorithm>

#include <pliant/body/contact_settings.h>

namespace pliant {

/// Returns the length of that step, s. Its error is of first order: for tolerances above 5e-4 the longest
/// step of the settings grows in proportion, at most ten times.
inline double longest_contact_step(const ContactSettings& settings, double tolerance) {
  constexpr double reference = 5e-4, max_factor = 10;
  return settings.longest_step * std::clamp(tolerance / reference, 1.0, max_factor);
}

}  // namespace pliant
