// The check of the key frames of a function of time.
#pragma once

#include <cmath>
#include <stdexcept>
#include <string>
#include <vector>

namespace pliant::detail {

/// Throws std::invalid_argument if there is no key, if the numbers of times and values differ, if a number is
/// not finite, or if the times (s) do not strictly increase.
inline void require_keys(const std::vector<double>& t, const std::vector<double>& y) {
  if (t.size() != y.size()) {
    throw std::invalid_argument("key frames: " + std::to_string(t.size()) + " times, but " +
                                std::to_string(y.size()) + " values");
  }
  if (t.empty()) throw std::invalid_argument("key frames: there is no key");
  for (std::size_t i = 0; i < t.size(); ++i) {
    const std::string key = "key frames: key " + std::to_string(i);
    if (!std::isfinite(t[i])) throw std::invalid_argument(key + " has a time that is not finite");
    if (!std::isfinite(y[i])) throw std::invalid_argument(key + " has a value that is not finite");
    if (i > 0 && !(t[i] > t[i - 1])) {
      throw std::invalid_argument(key + " is not later than the key before it; times must increase");
    }
  }
}

}  // namespace pliant::detail
