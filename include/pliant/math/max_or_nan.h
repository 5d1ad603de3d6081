// The larger of two numbers, or NaN if one of them is NaN.
#pragma once

#include <cmath>

namespace pliant {

/// Returns the larger of a and b, or NaN if one of them is NaN.
inline double max_or_nan(double a, double b) {
  return a <= b || std::isnan(b) ? b : a;
}

}  // namespace pliant
