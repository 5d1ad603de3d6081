// The conversion of an int to an index of a standard container.
#pragma once

#include <cstddef>

namespace pliant {

/// Returns i as std::size_t; i >= 0.
constexpr std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace pliant
