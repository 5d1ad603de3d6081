// The exponent of the growth of the cost with the size of a problem.
#pragma once

#include <cmath>
#include <vector>

namespace pliant::bench {

/// Returns the slope of log(total time) over log(size) by least squares. `time` is the time per unit of size:
/// the total is `time * size`.
template <class Cost, class Size>
double exponent(const std::vector<Cost>& costs, Size Cost::*size, double Cost::*time) {
  double x = 0, y = 0, xx = 0, xy = 0;
  const auto n = static_cast<double>(costs.size());
  for (const Cost& cost : costs) {
    const double a = std::log(cost.*size), b = std::log(cost.*time * cost.*size);
    x += a;
    y += b;
    xx += a * a;
    xy += a * b;
  }
  return (n * xy - x * y) / (n * xx - x * x);
}

}  // namespace pliant::bench
