// Round numbers along a scale.
#pragma once

#include <string>
#include <vector>

namespace pliant {

/// 1, 2 or 5 times a power of ten, of which about five make the span (> 0).
double tick_step(double span);

struct Tick {
  double value;
  std::string label;  ///< as many digits as the step needs
};
/// The multiples of the step that lie in [low, high].
std::vector<Tick> ticks(double low, double high);

}  // namespace pliant
