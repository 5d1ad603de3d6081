// The mesh pattern of balls: the lattice of a cube of 2m x 2m x 2m cells. Its upper and lower faces map to
// concentric rings, so that rims, edges and coordinate planes are mesh lines. A lattice point (i, j, k) of
// the shell r = max(|i|, |j|, |k|) has the direction that it has in the pattern of m = r.
#pragma once

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

using LatticePoint = std::array<int, 3>;

/// Returns the shell of a lattice point.
inline int ball_shell(const LatticePoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

/// Returns the direction of a lattice point other than the centre.
Vec3<double> ball_direction(const LatticePoint& p);

/// Shell m with its triangles, counter-clockwise seen from outside. Their diagonals point away from the
/// middles of the faces of the cube.
struct BallSurface {
  explicit BallSurface(int m);
  std::vector<LatticePoint> points;
  std::map<LatticePoint, int> index;  ///< number of each point in `points`
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace pliant
