// The exception that a material throws if its energy is not defined for an inverted or flat element.
#pragma once

#include <stdexcept>

namespace pliant {

/// An element is inverted (det F < 0), flat (det F = 0) or almost flat.
struct InvertedElement : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace pliant
