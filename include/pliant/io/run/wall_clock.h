// Wall time, for reports to the user. It has no influence on results.
#pragma once

#include <chrono>

namespace pliant {

using WallClock = std::chrono::steady_clock;

/// Returns the wall time since a point of time, s.
inline double seconds_since(WallClock::time_point start) {
  return std::chrono::duration<double>(WallClock::now() - start).count();
}

}  // namespace pliant
