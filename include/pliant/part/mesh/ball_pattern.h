// The mesh pattern of balls: the lattice of a cube of 2m x 2m x 2m cells. The upper and lower faces of the
// cube map to concentric rings, so that rims, edges and coordinate planes are mesh lines. Shell r of the
// lattice consists of the points (i, j, k) with max(|i|, |j|, |k|) = r. These points have the same directions
// as the surface points of the pattern with m = r.
#pragma once

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

using LatticePoint = std::array<int, 3>;

/// Returns the number r of the shell of a lattice point.
inline int ball_shell(const LatticePoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

/// Returns the direction (unit vector) of a lattice point. The point must not be the centre.
Vec3<double> ball_direction(const LatticePoint& p);

/// Shell m with its triangles, counter-clockwise seen from outside. Each cell of a face of the cube is cut
/// along the diagonal that points away from the middle of the face.
struct BallSurface {
  /// spacing: edge lengths of the cells of the faces along the axes of the lattice, in steps of the lattice.
  /// Each length must divide 2 m (not checked).
  explicit BallSurface(int m, const std::array<int, 3>& spacing = {1, 1, 1});
  std::vector<LatticePoint> points;
  std::map<LatticePoint, int> index;  ///< number of each point in `points`
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace pliant
