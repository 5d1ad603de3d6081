// Indices of the standard containers.
#pragma once

#include <cstddef>

namespace pliant {

constexpr std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace pliant
