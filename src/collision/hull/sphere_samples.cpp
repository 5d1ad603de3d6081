#include "sphere_samples.h"

#include <cmath>

namespace pliant {

namespace {
/// Neighbours are at most this far apart (rad); others are farther.
constexpr double kNeighbourAngle = 0.8;
/// The cosine of the angle between the ends of an edge of the icosahedron is 1 / sqrt(5), between other
/// corners it is negative.
constexpr double kEdgeOfIcosahedron = 0.4;
}  // namespace

SphereSamples::SphereSamples() {
  constexpr int kCorners = 12;
  const double golden = 0.5 * (1 + std::sqrt(5.0));
  std::size_t n = 0;
  for (int axis = 0; axis < 3; ++axis)
    for (const double one : {1.0, -1.0})
      for (const double other : {golden, -golden}) {
        Vec3<double> corner = Vec3<double>::Zero();
        corner[axis] = one;
        corner[(axis + 1) % 3] = other;
        directions[n++] = corner.normalized();
      }
  for (std::size_t i = 0; i < kCorners; ++i)
    for (std::size_t j = i + 1; j < kCorners; ++j)
      if (directions[i].dot(directions[j]) > kEdgeOfIcosahedron)
        directions[n++] = (directions[i] + directions[j]).normalized();
  for (std::size_t i = 0; i < kCount; ++i)
    for (std::size_t j = 0; j < kCount; ++j)
      if (i != j && directions[i].dot(directions[j]) > std::cos(kNeighbourAngle))
        neighbours[i].push_back(static_cast<int>(j));
}

const SphereSamples& SphereSamples::shared() {
  static const SphereSamples samples;
  return samples;
}

}  // namespace pliant
