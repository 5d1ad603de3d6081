// Where the energy of a material is not defined.
#pragma once

#include <stdexcept>

namespace pliant {

/// An element is turned inside out or squeezed flat.
struct InvertedElement : std::runtime_error {
  using std::runtime_error::runtime_error;
};

}  // namespace pliant
