// How long steps to a tolerance may be while bodies lie on each other and their error is not controlled.
#pragma once

#include <algorithm>

#include <pliant/body/contact_settings.h>

namespace pliant {

/// Longest such step, s. What it is wrong by is of first order: to tolerances above 5e-4 the longest step of
/// the settings may be longer in proportion, up to ten times.
inline double longest_contact_step(const ContactSettings& settings, double tolerance) {
  constexpr double exact = 5e-4, most = 10;
  return settings.longest_step * std::clamp(tolerance / exact, 1.0, most);
}

}  // namespace pliant
