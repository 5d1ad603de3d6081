// Directions all over the unit sphere: the corners of an icosahedron and the middles of its edges.
#pragma once

#include <array>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

struct SphereSamples {
  static constexpr int kCount = 42;
  std::array<Vec3<double>, kCount> directions;
  std::array<std::vector<int>, kCount> neighbours;  ///< numbers of the five or six nearest directions

  /// Returns the samples, computed at the first call.
  static const SphereSamples& shared();

 private:
  SphereSamples();
};

}  // namespace pliant
