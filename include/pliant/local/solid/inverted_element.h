// The exception that a material throws if its energy is not defined for an inverted or flat element.
#pragma once

#include <stdexcept>
#include <string>

namespace pliant {

/// An element is inverted (det F < 0), flat (det F = 0) or almost flat.
struct InvertedElement : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// Returns act(). If act() throws InvertedElement, throws it again with the name of the part in its message.
template <class F>
auto with_name_of_part(const std::string& part, F&& act) {
  try {
    return act();
  } catch (const InvertedElement& failure) {
    throw InvertedElement("part '" + part + "': " + failure.what());
  }
}

}  // namespace pliant
