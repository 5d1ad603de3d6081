// Round numbers along a scale.
#pragma once

#include <string>
#include <vector>

namespace pliant {

/// Returns the step of a scale: 1, 2 or 5 times a power of ten, so that about five steps fill the span (> 0).
double tick_step(double span);

struct Tick {
  double value;
  std::string label;  ///< with as many digits as the step needs
};
/// Returns the multiples of tick_step(high - low) in [low, high], in increasing order; at most the first 12.
/// low < high.
std::vector<Tick> ticks(double low, double high);

}  // namespace pliant
