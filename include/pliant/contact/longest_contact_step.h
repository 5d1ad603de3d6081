// The longest step to a tolerance while bodies rest on each other and the error of contact is not controlled.
#pragma once

#include <algorithm>

#include <pliant/body/contact_settings.h>

namespace pliant {

/// Returns the longest step, s. Its error is of first order: for tolerances above 5e-4 it is longer than the
/// setting in proportion, at most ten times.
inline double longest_contact_step(const ContactSettings& settings, double tolerance) {
  constexpr double exact = 5e-4, most = 10;
  return settings.longest_step * std::clamp(tolerance / exact, 1.0, most);
}

}  // namespace pliant
